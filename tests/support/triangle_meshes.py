"""Triangle surfaces of simple shapes, with normals outward."""

import numpy as np


def box(size, parts=1):
    """Return corners and triangles of a box around the origin, each face with parts x parts rectangles."""
    vertices, faces = [], []
    half = np.array(size) / 2
    steps = np.linspace(-1.0, 1.0, parts + 1)
    for axis in range(3):
        one, other = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1, 1):
            start = len(vertices)
            for u in steps:
                for v in steps:
                    corner = np.zeros(3)
                    corner[[axis, one, other]] = side, u, v
                    vertices.append(corner * half)
            for i in range(parts):
                for j in range(parts):
                    a = start + i * (parts + 1) + j
                    b, c, d = a + parts + 1, a + parts + 2, a + 1
                    faces += [(a, b, c), (a, c, d)] if side > 0 else [(a, c, b), (a, d, c)]
    return np.array(vertices), np.array(faces)


def blocks(filled, width):
    """Return corners and triangles of the surface of a grid of cubes around the origin, of which some are filled."""
    vertices, faces = [], []
    filled = np.pad(np.asarray(filled, bool), 1)
    middle = np.array(filled.shape) / 2
    for cell in np.argwhere(filled):
        for axis in range(3):
            one, other = np.roll(np.eye(3), axis + 1, axis=0)[[0, 1]]
            normal = np.cross(one, other)
            for side in (-1, 1):
                if filled[tuple((cell + side * normal).astype(int))]:
                    continue
                start = len(vertices)
                corner = cell + (normal if side > 0 else 0)
                vertices += [corner, corner + one, corner + one + other, corner + other]
                a, b, c, d = range(start, start + 4)
                faces += [(a, b, c), (a, c, d)] if side > 0 else [(a, c, b), (a, d, c)]
    return (np.array(vertices) - middle) * width, np.array(faces)


def cylinder(radius, length, around, along=1):
    """Return corners and triangles of a cylinder along z, whose facets have the cylinder's mean distance from its axis."""
    # The facets are as far inside of the cylinder as their edges are outside.
    rim = radius * 2 / (1 + np.cos(np.pi / around))
    angles = 2 * np.pi * np.arange(around) / around
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1) * rim
    heights = np.linspace(-length / 2, length / 2, along + 1)
    vertices = [np.column_stack([ring, np.full(around, z)]) for z in heights]
    vertices += [np.array([[0, 0, heights[0]], [0, 0, heights[-1]]])]
    faces = []
    for k in range(along):
        for a in range(around):
            b = (a + 1) % around
            low, high = k * around, (k + 1) * around
            faces += [(low + a, low + b, high + b), (low + a, high + b, high + a)]
    bottom, top, last = (along + 1) * around, (along + 1) * around + 1, along * around
    for a in range(around):
        b = (a + 1) % around
        faces += [(bottom, b, a), (top, last + a, last + b)]
    return np.concatenate(vertices), np.array(faces)


def ball(radius, parts):
    """Return corners and triangles of a sphere: an octahedron whose faces are divided into parts x parts triangles."""
    vertices, faces = [], []
    corners = np.concatenate([np.eye(3), -np.eye(3)])
    for i in (0, 3):
        for j in (1, 4):
            for k in (2, 5):
                a, b, c = corners[i], corners[j], corners[k]
                if np.dot(np.cross(b - a, c - a), a + b + c) < 0:
                    b, c = c, b
                start = {}
                for u in range(parts + 1):
                    for v in range(parts + 1 - u):
                        start[u, v] = len(vertices)
                        point = a + (b - a) * u / parts + (c - a) * v / parts
                        vertices.append(radius * point / np.linalg.norm(point))
                for u in range(parts):
                    for v in range(parts - u):
                        faces.append((start[u, v], start[u + 1, v], start[u, v + 1]))
                        if u + v < parts - 1:
                            faces.append((start[u + 1, v], start[u + 1, v + 1], start[u, v + 1]))
    return np.array(vertices), np.array(faces)


def step_box(size, unit=".MILLI.,.METRE."):
    """Return the text of a STEP file of a box with a corner at the origin."""
    lines, number = [], 100

    def add(text):
        nonlocal number
        number += 1
        lines.append(f"#{number}={text};")
        return f"#{number}"

    def point(p):
        return add(f"CARTESIAN_POINT('',({','.join(f'{x:.9g}.' if x == int(x) else f'{x:.9g}' for x in p)}))")

    def direction(d):
        return add(f"DIRECTION('',({','.join(f'{x:.1f}' for x in d)}))")

    corners = {(i, j, k): np.array([i, j, k]) * size for i in (0, 1) for j in (0, 1) for k in (0, 1)}
    vertex = {key: add(f"VERTEX_POINT('',{point(p)})") for key, p in corners.items()}
    edge = {}
    for start in corners:
        for axis in range(3):
            if start[axis] == 0:
                end = tuple(1 if a == axis else start[a] for a in range(3))
                line = add(f"LINE('',{point(corners[start])},{add(f'''VECTOR('',{direction(np.eye(3)[axis])},1.)''')})")
                edge[start, end] = add(f"EDGE_CURVE('',{vertex[start]},{vertex[end]},{line},.T.)")
    faces = []
    for axis in range(3):
        one, other = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, 1):
            loop = []
            for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                key = [0, 0, 0]
                key[axis], key[one], key[other] = side, u, v
                loop.append(tuple(key))
            loop = loop if side else loop[::-1]
            oriented = []
            for a, b in zip(loop, loop[1:] + loop[:1], strict=True):
                forward = (a, b) in edge
                name = edge[(a, b) if forward else (b, a)]
                oriented.append(add(f"ORIENTED_EDGE('',*,*,{name},{'.T.' if forward else '.F.'})"))
            bound = add(f"FACE_OUTER_BOUND('',{add(f'''EDGE_LOOP('',({','.join(oriented)}))''')},.T.)")
            normal = np.eye(3)[axis] * (1 if side else -1)
            place = add(
                f"AXIS2_PLACEMENT_3D('',{point(corners[loop[0]])},{direction(normal)},{direction(np.eye(3)[one])})"
            )
            faces.append(add(f"ADVANCED_FACE('',({bound}),{add(f'''PLANE('',{place})''')},.T.)"))
    brep = add(f"MANIFOLD_SOLID_BREP('box',{add(f'''CLOSED_SHELL('',({','.join(faces)}))''')})")
    head = f"""ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('box','2026-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));
ENDSEC;
DATA;
#1=APPLICATION_CONTEXT('automotive design');
#2=PRODUCT_CONTEXT('',#1,'mechanical');
#3=PRODUCT('box','box','',(#2));
#4=PRODUCT_DEFINITION_FORMATION('','',#3);
#5=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#6=PRODUCT_DEFINITION('design','',#4,#5);
#7=PRODUCT_DEFINITION_SHAPE('','',#6);
#10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({unit}));
#11=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#12=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#13=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-06),#10,'distance_accuracy_value','');
#14=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#13))
GLOBAL_UNIT_ASSIGNED_CONTEXT((#10,#11,#12))REPRESENTATION_CONTEXT('',''));
#15=ADVANCED_BREP_SHAPE_REPRESENTATION('',({brep}),#14);
#16=SHAPE_DEFINITION_REPRESENTATION(#7,#15);
"""
    return head + "\n".join(lines) + "\nENDSEC;\nEND-ISO-10303-21;\n"
