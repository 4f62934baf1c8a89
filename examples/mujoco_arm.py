"""A ball on an arm in MuJoCo
==========================

For users of MuJoCo: an impact damper at the tip of a robot arm.

The arm turns about a hinge with the stiffness of its drive and vibrates after a stop. MuJoCo integrates the arm, Rattlebox
the ball; after each step they exchange the velocity of the tip and the force of the ball. For the small angles here the
arm is a mass on a spring, so that `rb.simulate` checks the result. Needs `pip install '.[examples]'`.

:doc:`/how-to/stepper` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "coupling"]

import matplotlib.pyplot as plt
import mujoco
import numpy as np

import rattlebox as rb

# %%
# The arm is a rigid body on a hinge, whose spring is the drive.

STEP, DURATION = 5e-5, 0.4  # s
ARM = """
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="arm">
      <joint name="hinge" type="hinge" axis="0 0 1" stiffness="987" damping="0.2"/>
      <inertial pos="0.3 0 0" mass="1.6" diaginertia="0.01 0.106 0.106"/>
      <site name="tip" pos="0.5 0 0"/>
    </body>
  </worldbody>
</mujoco>
"""  # moment of inertia about the hinge: 0.25 kg m^2, at the tip 1 kg
SPEED = 0.3  # of the tip after the stop, m/s


# %%
# The damper sits at the tip. Soft pads make contacts long enough for the steps of MuJoCo.


def ball():
    """Return a tungsten carbide ball of 0.11 kg between pads, which moves with the arm at first."""
    sphere = rb.Sphere(radius="12 mm", material="tungsten_carbide")
    pads = rb.Linear(stiffness="200 kN/m", restitution=0.5)
    return rb.ImpactDamper(ball=sphere, gap="5 mm", contact=pads, velocity=f"{SPEED} m/s")


# %%
# Each step has two halves: MuJoCo computes positions, the damper answers with a force, and MuJoCo finishes the step.


def coupled(damped=True, step=STEP):
    """Return times and displacements of the tip across the arm, by MuJoCo with Rattlebox [s], [m]."""
    model = mujoco.MjModel.from_xml_string(ARM)
    model.opt.timestep = step
    data = mujoco.MjData(model)
    tip, arm = data.site("tip").id, data.body("arm").id
    data.qvel[0] = SPEED / 0.5
    damper, force, velocity, path = rb.Stepper(ball(), structure_mass="1 kg", velocity=SPEED), 0.0, np.zeros(6), [0.0]
    for _ in range(round(DURATION / step)):
        mujoco.mj_step1(model, data)
        if damped and data.time > 0:
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_SITE, tip, velocity, 1)  # rotation, translation
            force = damper.advance(data.time, velocity=velocity[4]).force
        across = data.site(tip).xmat.reshape(3, 3)[:, 1]
        data.qfrc_applied[:] = 0
        mujoco.mj_applyFT(model, data, force * across, np.zeros(3), data.site(tip).xpos, arm, data.qfrc_applied)
        mujoco.mj_step2(model, data)
        path.append(0.5 * data.qpos[0])
    return step * np.arange(len(path)), np.array(path)


# %%
# For small angles the arm is a mass on a spring, which Rattlebox alone can simulate.


def whole_run():
    """Return the same by `rb.simulate`."""
    arm = rb.SDOF(mass="1 kg", stiffness=987 / 0.25, damping=0.2 / 0.25, velocity=SPEED)
    run = rb.simulate(rb.Case(structure=arm, damper=ball(), duration=DURATION), progress=False)
    return run.motion.time.values, run.motion.displacement.values[:, 0]


def difference(step=STEP):
    """Return the largest difference of both over the largest displacement."""
    (t, x), (time, whole) = coupled(step=step), whole_run()
    return np.abs(np.interp(time, t, x) - whole).max() / np.abs(whole).max()


# %%
# Both agree, and the ball takes more than half of the motion within 0.3 s.


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    (t, x), bare = coupled(), coupled(damped=False)[1]
    late = np.abs(x[t > 0.3]).max() / np.abs(bare[t > 0.3]).max()
    print(f"after 0.3 s {100 * late:.0f} % of that without the ball; rb.simulate differs by {100 * difference():.1f} %")
    figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
    axes.plot(t, 1e3 * bare, "0.7", label="without ball")
    axes.plot(t, 1e3 * x, label="MuJoCo with Rattlebox")
    axes.plot(whole_run()[0], 1e3 * whole_run()[1], ":", lw=1.6, label="rb.simulate")
    axes.set(xlabel="Time (s)", ylabel="Displacement of the tip (mm)", xlim=(0, DURATION))
    axes.legend(ncols=3, loc="upper right")
    axes.set_ylim(top=7)
    figure.savefig("mujoco_arm.png", dpi=200)
    assert 0.43 < late < 0.47 and difference() < 0.006


if __name__ == "__main__":
    main()
