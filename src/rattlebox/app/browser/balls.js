// Structure and balls on a line, drawn with the play in the cavity enlarged so that it can be seen.
import { fetchBody } from "rattlebox-binary";

export default {
  template: `<div style="width:100%">
    <canvas style="width:100%;height:190px;display:block" role="img" aria-label="animation of structure and balls"></canvas>
    <div style="display:flex;gap:10px;align-items:center;font-size:13px">
      <button type="button" @click="playing = !playing" style="min-width:56px;border:1px solid #999;border-radius:4px;padding:2px 8px">{{ playing ? "Pause" : "Play" }}</button>
      <input type="range" min="0" max="1" step="0.0005" v-model.number="part" style="flex:1" aria-label="time" @input="playing = false">
      <span style="min-width:90px">t = {{ now.toPrecision(3) }} s</span>
      <label>speed <select v-model.number="speed"><option v-for="s in [0.01, 0.03, 0.1, 0.3, 1]" :value="s">{{ s }}x</option></select></label>
    </div></div>`,
  props: { url: String },
  data: () => ({ playing: true, part: 0, now: 0, speed: 0.1 }),
  mounted() {
    this.due = 0;
    this.load();
    // At most 30 frames a second, fewer while new runs arrive, none if nothing changed: without a graphics card each costs 25 ms.
    const step = (at) => { if (at >= this.due) this.advance(at); this.request = requestAnimationFrame(step); };
    this.request = requestAnimationFrame(step);
  },
  unmounted() { cancelAnimationFrame(this.request); },
  watch: { url() { this.load(); } },
  methods: {
    async load() {
      const url = this.url;
      this.run = null;
      if (!url) return;
      try {
        const run = await fetchBody(url);
        if (url !== this.url) return;
        run.reach = (run.arrays["frame displacement"] || []).reduce((most, x) => Math.max(most, Math.abs(x)), 1e-9);
        this.run = run;
        this.drawn = "";
        this.advance(performance.now());
        this.due = this.last + 200;
      } catch (error) { console.warn("no animation:", error.message); }
    },
    advance(at) {
      if (!this.run) return;
      if (this.playing) this.part = (this.part + (this.speed * Math.min(at - (this.last || at), 200)) / 1000 / this.run.about.end) % 1;
      this.last = at;
      this.due = at + 30;
      const state = `${this.part} ${this.$el.clientWidth}`;
      if (state !== this.drawn) this.draw();
      this.drawn = state;
    },
    draw() {
      const canvas = this.$el.querySelector("canvas"), ratio = window.devicePixelRatio || 1;
      const width = canvas.clientWidth, height = canvas.clientHeight;
      if (!width) return;
      if (canvas.width !== Math.round(width * ratio)) { canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio); }
      const pen = canvas.getContext("2d");
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.clearRect(0, 0, width, height);
      const { arrays, shapes, about, reach } = this.run, times = arrays["frame time"];
      const count = times.length, k = Math.min(count - 1, Math.floor(this.part * count));
      this.now = times[k];
      const shift = arrays["frame displacement"], places = arrays["frame place"];
      const dampers = about.gaps.length, house = Math.min(300, width * 0.4), room = (width - house) / 2 - 40;
      const scale = room / reach, centre = width / 2 + (shift ? shift[k] * scale : 0), top = 26, lane = (height - 62) / Math.max(1, dampers);
      // ground, spring, structure
      pen.strokeStyle = "#555"; pen.lineWidth = 1.5; pen.fillStyle = "#777";
      pen.fillRect(6, top - 8, 5, height - 46);
      const left = centre - house / 2, coils = 9, y = height / 2;
      pen.beginPath(); pen.moveTo(11, y);
      for (let i = 0; i <= coils; i++) pen.lineTo(20 + ((left - 30) * i) / coils, y + (i === 0 || i === coils ? 0 : i % 2 ? -9 : 9));
      pen.lineTo(left, y); pen.stroke();
      pen.fillStyle = "#dfe6ee"; pen.strokeStyle = "#33475b"; pen.lineWidth = 2;
      pen.beginPath(); pen.rect(left, top - 8, house, height - 46); pen.fill(); pen.stroke();
      const flash = arrays["frame flash"] ? arrays["frame flash"][k] : 0;
      for (let d = 0; d < dampers; d++) {
        const members = about.damper_of_ball.map((owner, ball) => [owner, ball]).filter(([owner]) => owner === d).map(([, ball]) => ball);
        const inside = house - 36, radius = Math.min(lane * 0.36, inside / (2.6 * members.length)), play = (inside - 2 * radius * members.length) / 2;
        const bottom = top + lane * d;
        pen.fillStyle = "#fff"; pen.strokeStyle = "#33475b";
        pen.beginPath(); pen.rect(centre - inside / 2, bottom + lane / 2 - radius - 3, inside, 2 * radius + 6); pen.fill(); pen.stroke();
        members.forEach((ball, i) => {
          const offset = (2 * i - members.length + 1) * radius;
          const at = centre + offset + (places[ball * shapes["frame place"][1] + k] / about.gaps[d]) * play;
          pen.fillStyle = `rgb(${Math.round(70 + 185 * flash)}, ${Math.round(110 + 60 * flash)}, ${Math.round(160 - 110 * flash)})`;
          pen.beginPath(); pen.arc(at, bottom + lane / 2, radius, 0, 2 * Math.PI); pen.fill(); pen.stroke();
        });
      }
      pen.fillStyle = "#444"; pen.font = "12px sans-serif";
      pen.fillText(`largest displacement ${reach.toPrecision(3)} mm` + (dampers ? `, gap ${about.gaps.map((gap) => gap.toPrecision(3)).join(", ")} mm (enlarged); contacts flash` : ""), 20, height - 8);
      window.rbFrame = k;
    },
  },
};
