// Particles in their moving cavities: instanced spheres that are played, scrubbed, cut and coloured.
import { THREE, OrbitControls } from "nicegui-scene";
import { fetchBody } from "rattlebox-binary";

const VIRIDIS = ["#440154", "#414487", "#2a788e", "#22a884", "#7ad151", "#fde725"].map((hex) => new THREE.Color(hex));
const SPECIES = ["#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377"].map((hex) => new THREE.Color(hex));

function shade(part, colour) {
  const place = Math.max(0, Math.min(0.9999, part)) * (VIRIDIS.length - 1), lower = Math.floor(place);
  return colour.lerpColors(VIRIDIS[lower], VIRIDIS[lower + 1], place - lower);
}

export default {
  template: `<div style="width:100%">
    <div class="rb-scene" style="width:100%;height:400px;position:relative"></div>
    <div style="display:flex;gap:10px;align-items:center;flex-wrap:wrap;font-size:13px">
      <button type="button" @click="playing = !playing" style="min-width:56px;border:1px solid #999;border-radius:4px;padding:2px 8px">{{ playing ? "Pause" : "Play" }}</button>
      <input type="range" min="0" :max="Math.max(0, count - 1)" step="1" v-model.number="frame" style="flex:1;min-width:120px" aria-label="time" @input="playing = false; show()">
      <span style="min-width:150px">t = {{ now.toPrecision(3) }} s, {{ count }} frames</span>
      <label>speed <select v-model.number="rate"><option v-for="r in [5, 10, 30, 60]" :value="r">{{ r }} frames/s</option></select></label>
      <label>colour <select v-model="colour" @change="show()"><option value="speed">speed</option><option value="spin">spin</option><option value="species">species</option></select></label>
      <label style="display:inline-flex;align-items:center;gap:4px">cut <input type="range" min="-1" max="1" step="0.02" v-model.number="cut" @input="show()" style="width:90px" aria-label="cut plane"></label>
      <span v-if="count && colour !== 'species'">0 to {{ top[colour].toPrecision(3) }} {{ colour === "speed" ? "m/s" : "rad/s" }} (dark to bright)</span>
    </div></div>`,
  props: { url: String, growing: Boolean },
  data: () => ({ playing: true, frame: 0, count: 0, now: 0, rate: 30, colour: "speed", cut: 1, top: { speed: 1e-9, spin: 1e-9 } }),
  mounted() { this.load(true); },
  unmounted() {
    clearTimeout(this.timer);
    if (!this.view) return;
    cancelAnimationFrame(this.request); this.observer.disconnect();
    this.view.renderer.dispose(); this.view.renderer.forceContextLoss(); this.view = null;
  },
  watch: { url() { this.load(true); }, growing(now) { if (!now) this.load(false); } },
  methods: {
    // Without a graphics card a scene costs a whole core: it is made when there are particles, and drawn when it changes.
    open() {
      const box = this.$el.querySelector(".rb-scene"), scene = new THREE.Scene();
      scene.background = new THREE.Color("#f7f7f5");
      const camera = new THREE.PerspectiveCamera(35, 2, 0.001, 1000);
      camera.up.set(0, 0, 1);
      const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
      box.appendChild(renderer.domElement);
      scene.add(new THREE.HemisphereLight("#ffffff", "#777788", 2.2));
      const sun = new THREE.DirectionalLight("#ffffff", 2);
      sun.position.set(2, -3, 5);
      scene.add(sun);
      this.view = { box, scene, camera, renderer, controls: new OrbitControls(camera, renderer.domElement), mesh: null, walls: [], frames: [] };
      const resize = () => { const width = box.clientWidth || 600; renderer.setSize(width, 400); camera.aspect = width / 400; camera.updateProjectionMatrix(); this.stale = true; };
      this.view.controls.addEventListener("change", () => { this.stale = true; });
      this.observer = new ResizeObserver(resize);
      this.observer.observe(box);
      resize();
      let due = 0, shown = 0, start = 0;
      const step = (at) => {
        if (!this.view) return;
        this.request = requestAnimationFrame(step);
        if (!box.clientWidth) return;
        if (this.playing && this.count > 1 && at >= due) { this.frame = (this.frame + 1) % this.count; due = Math.max(due + 1000 / this.rate, at - 50); this.show(); }
        if (!this.stale) return;
        this.stale = false;
        renderer.render(scene, camera);
        start = start || at;
        window.rbFps = (1000 * shown++) / (at - start + 1);
      };
      this.request = requestAnimationFrame(step);
    },
    async load(fresh) {
      clearTimeout(this.timer);
      const url = this.url;
      if (url && !this.view) this.open();
      if (fresh && this.view) {
        this.clear();
        Object.assign(this, { count: 0, frame: 0, next: 0, now: 0, top: { speed: 1e-9, spin: 1e-9 } });
      }
      if (!url) return;
      try {
        const first = this.next || 0, body = await fetchBody(`${url}?first=${first}`);
        if (url !== this.url || !this.view) return;
        if (first !== (this.next || 0)) return this.load(false); // another request has brought these frames
        this.append(body);
      } catch (error) { console.warn("no particles yet:", error.message); }
      if (this.growing) this.timer = setTimeout(() => this.load(false), 700);
    },
    append({ arrays, shapes, about }) {
      if (!arrays.position) return;
      const [frames, particles] = shapes.position;
      if (!this.view.frames.length) this.build(arrays, about, particles);
      for (let f = 0; f < frames; f++)
        this.view.frames.push({
          time: arrays.time[f], position: arrays.position.subarray(3 * f * particles, 3 * (f + 1) * particles),
          shift: arrays.shift.subarray(f * shapes.shift[1] * 3, (f + 1) * shapes.shift[1] * 3),
          speed: arrays.speed.subarray(f * particles, (f + 1) * particles), spin: arrays.spin.subarray(f * particles, (f + 1) * particles),
        });
      for (const name of ["speed", "spin"]) this.top[name] = arrays[name].reduce((most, value) => Math.max(most, value), this.top[name]);
      this.next = about.next;
      this.count = this.view.frames.length;
      this.show();
    },
    clear() {
      for (const old of [this.view.mesh, ...this.view.walls]) if (old) { this.view.scene.remove(old); old.traverse((part) => part.geometry?.dispose()); }
      Object.assign(this.view, { frames: [], mesh: null, walls: [] });
      this.stale = true;
    },
    build(arrays, about, particles) {
      const { scene, camera, controls } = this.view;
      const detail = particles > 3000 ? 1 : 2;
      this.view.mesh = new THREE.InstancedMesh(new THREE.IcosahedronGeometry(1, detail), new THREE.MeshStandardMaterial({ roughness: 0.4 }), particles);
      this.view.mesh.frustumCulled = false;
      scene.add(this.view.mesh);
      this.view.fixed = { radius: arrays.radius, species: arrays.species, cavity: arrays.cavity };
      this.view.walls = about.cavities.map(({ sharp, smooth, place }) => {
        const walls = new THREE.Group();
        for (const [ends, opacity] of [[sharp, 1], [smooth, 0.15]]) {
          const shape = new THREE.BufferGeometry();
          shape.setAttribute("position", new THREE.Float32BufferAttribute(ends, 3));
          walls.add(new THREE.LineSegments(shape, new THREE.LineBasicMaterial({ color: "#555", transparent: true, opacity })));
        }
        walls.userData.place = place;
        scene.add(walls);
        return walls;
      });
      this.view.places = about.cavities.map((cavity) => cavity.place);
      this.view.reach = about.reach;
      camera.position.set(1.1 * about.reach, -2 * about.reach, 0.9 * about.reach);
      camera.near = about.reach / 100; camera.far = 100 * about.reach; camera.updateProjectionMatrix();
      controls.target.set(0, 0, 0); controls.update();
    },
    show() {
      const current = this.view && this.view.frames[Math.min(this.frame, this.count - 1)];
      if (!current) return;
      this.now = current.time;
      const { mesh, walls, places, reach, fixed } = this.view, matrix = new THREE.Matrix4(), colour = new THREE.Color();
      walls.forEach((wall, c) => wall.position.set(...[0, 1, 2].map((axis) => places[c][axis] + current.shift[3 * c + axis])));
      const top = this.top[this.colour] || 1;
      for (let i = 0; i < mesh.count; i++) {
        const place = places[fixed.cavity[i]], radius = fixed.radius[i];
        const [x, y, z] = [0, 1, 2].map((axis) => current.position[3 * i + axis] + place[axis]);
        const size = y > -this.cut * reach / 2 || this.cut >= 1 ? radius : 0;
        matrix.makeScale(size, size, size).setPosition(x, y, z);
        mesh.setMatrixAt(i, matrix);
        mesh.setColorAt(i, this.colour === "species" ? SPECIES[fixed.species[i] % SPECIES.length] : shade(current[this.colour][i] / top, colour));
      }
      mesh.instanceMatrix.needsUpdate = true;
      mesh.instanceColor.needsUpdate = true;
      this.stale = true;
      window.rbParticles = { particles: mesh.count, frames: this.count, frame: this.frame };
    },
  },
};
