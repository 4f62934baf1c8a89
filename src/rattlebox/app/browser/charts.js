// Charts of a run. The body that `url` names lists the charts and holds their numbers.
import { echarts } from "nicegui-echart";
import { fetchBody } from "rattlebox-binary";

const GREY = "#555";
const COLOURS = ["#0b3d6b", "#d1742c", "#5f9ea0", "#a33b5c", "#8c8c2e", "#7a6fb0"]; // rattlebox.plots.SERIES_COLOURS, which needs Matplotlib

// Lines of thousands of points are drawn by the processor: a graphics card gains nothing, and its emulation takes 300 ms.
const context = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, options) {
  return context.call(this, kind, kind === "2d" ? { willReadFrequently: true, ...options } : options);
};

function series(entry, arrays, shapes) {
  const x = arrays[entry.x], count = x.length;
  const y = arrays[entry.y], row = entry.row === undefined ? 0 : entry.row;
  const samples = shapes[entry.x].length > 1 ? shapes[entry.x][1] : count, xRow = shapes[entry.x].length > 1 ? row : 0;
  const data = new Float32Array(2 * samples); // pairs in one array: thousands of small ones cost 20 ms of collection
  for (let i = 0; i < samples; i++) { data[2 * i] = x[xRow * samples + i]; data[2 * i + 1] = y[row * samples + i]; }
  const dots = entry.dots === true, color = COLOURS[entry.colour % COLOURS.length];
  return {
    name: entry.name, type: dots ? "scatter" : "line", data, dimensions: ["x", "y"], symbol: dots ? "circle" : "none", symbolSize: 4, animation: false,
    sampling: entry.portrait ? undefined : "lttb", large: dots, itemStyle: { color },
    lineStyle: { width: entry.portrait ? 0.7 : 1.3, color, type: entry.dash ? "dashed" : "solid" },
  };
}

export default {
  template: `<div class="rb-charts" style="display:grid;gap:8px;width:100%"></div>`,
  props: { url: String, columns: Number },
  data: () => ({ charts: [], wanted: "", busy: false }),
  mounted() {
    this.observer = new ResizeObserver(() => this.charts.forEach((chart) => chart.resize()));
    this.observer.observe(this.$el);
    this.update();
  },
  unmounted() { this.observer.disconnect(); this.charts.forEach((chart) => chart.dispose()); },
  watch: { url() { this.update(); } },
  methods: {
    async update() {
      this.wanted = this.url;
      if (this.busy || !this.url) return;
      this.busy = true;
      try {
        while (this.wanted) {
          const url = this.wanted;
          this.wanted = "";
          this.draw(await fetchBody(url));
        }
      } catch (error) { console.warn("no charts:", error.message); } finally { this.busy = false; }
    },
    draw({ arrays, shapes, about }) {
      const specs = about.charts || [];
      this.$el.style.gridTemplateColumns = `repeat(${this.columns || 2}, minmax(0, 1fr))`;
      while (this.charts.length > specs.length) { const last = this.charts.pop(); const dom = last.getDom(); last.dispose(); dom.remove(); }
      while (this.charts.length < specs.length) {
        const box = document.createElement("div");
        box.style.height = "245px";
        this.$el.appendChild(box);
        this.charts.push(echarts.init(box));
      }
      specs.forEach((spec, index) => {
        const chart = this.charts[index], dom = chart.getDom();
        const text = spec.series.reduce((sum, { name }) => sum + 48 + 6.3 * name.length, 0);
        const rows = spec.series.length > 1 ? Math.ceil(text / (dom.clientWidth - 30)) : 0;
        if (dom.style.height !== `${245 + 18 * rows}px`) { dom.style.height = `${245 + 18 * rows}px`; chart.resize(); }
        chart.setOption({
        title: { text: spec.title, left: 4, top: 0, textStyle: { fontSize: 13, fontWeight: 600, color: "#222" } },
        legend: { show: rows > 0, top: 18, left: 4, itemWidth: 18, itemHeight: 8, itemGap: 7, textStyle: { fontSize: 11 } },
        grid: { left: 62, right: 16, top: 30 + 18 * rows, bottom: 42 },
        tooltip: { trigger: spec.portrait ? "item" : "axis", confine: true, valueFormatter: (value) => Number(value).toPrecision(4) },
        xAxis: { type: "value", name: spec.x, nameLocation: "middle", nameGap: 26, scale: true, axisLine: { onZero: false }, splitLine: { show: false }, nameTextStyle: { color: GREY }, min: spec.range ? spec.range[0] : undefined, max: spec.range ? spec.range[1] : undefined },
        yAxis: { type: spec.log ? "log" : "value", name: spec.y, nameLocation: "middle", nameGap: 46, scale: true, axisLine: { onZero: false }, nameTextStyle: { color: GREY } },
        dataZoom: spec.portrait ? [] : [{ type: "inside" }],
        series: spec.series.map((entry) => series(entry, arrays, shapes)),
        }, { replaceMerge: ["series"] });
      });
      window.rbDrawn = { count: (window.rbDrawn ? window.rbDrawn.count : 0) + 1, at: performance.now() };
    },
  },
};
