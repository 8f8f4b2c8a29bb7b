// Draws every figure of the page from the data beside it, in the page's colours, and zooms linked figures together.
"use strict";
(() => {
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const template = (night) => {
    const ink = night ? "#e3e8ee" : "#1c2430", grid = night ? "#313a46" : "#dfe4ea", clear = "rgba(0,0,0,0)";
    const axis = { gridcolor: grid, zerolinecolor: night ? "#4a5666" : "#b9c2cc", linecolor: grid, ticks: "outside", tickcolor: grid,
                   showspikes: true, spikemode: "across", spikethickness: 1, spikecolor: "#888888", spikedash: "dot" };
    return { layout: {
      font: { color: ink, size: 12, family: "system-ui, sans-serif" }, paper_bgcolor: clear, plot_bgcolor: clear,
      margin: { l: 64, r: 16, t: 34, b: 46 }, xaxis: axis, yaxis: axis,
      legend: { orientation: "h", x: 0, y: 1, yanchor: "bottom", xanchor: "left" }, hoverlabel: { namelength: -1, bgcolor: night ? "#232a33" : "#ffffff", font: { color: ink } },
      modebar: { bgcolor: clear, color: "#98a4b3", activecolor: "#2b7bbd" }, annotationdefaults: { font: { color: ink } },
    } };
  };
  const configuration = { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["lasso2d", "select2d"],
                          toImageButtonOptions: { format: "svg" } };
  const charts = [];
  // What part of a common axis is shown, by the name of the link; a figure that is drawn later begins there.
  const ranges = {};
  const linked = (source, change) => {
    const range = change["xaxis.range[0]"] !== undefined
      ? { "xaxis.range": [change["xaxis.range[0]"], change["xaxis.range[1]"]] }
      : change["xaxis.range"] ? { "xaxis.range": change["xaxis.range"] }
      : change["xaxis.autorange"] ? { "xaxis.autorange": true } : null;
    if (!range) return;
    ranges[source.dataset.link] = range;
    for (const chart of charts) {
      if (chart === source || chart.dataset.link !== source.dataset.link) continue;
      chart.following = true;
      Plotly.relayout(chart, range).then(() => { chart.following = false; });
    }
  };
  const colour = (night) => charts.forEach((chart) => Plotly.relayout(chart, { template: template(night) }));

  // Figures that are hidden have no width; they are drawn when they are shown.
  const draw = () => document.querySelectorAll(".chart:not(.drawn)").forEach((chart) => {
    if (chart.closest("[hidden]")) return;
    const drawing = JSON.parse(document.getElementById(chart.id + "-data").textContent);
    const { link } = chart.dataset;
    // Series on the places of an earlier one have its number instead.
    drawing.data.forEach((series) => { if (typeof series.x === "number") series.x = drawing.data[series.x].x; });
    drawing.layout.template = template(dark.matches);
    chart.classList.add("drawn");
    Plotly.newPlot(chart, drawing.data, drawing.layout, configuration);
    charts.push(chart);
    if (!link) return;
    if (ranges[link]) {
      chart.following = true;
      Plotly.relayout(chart, ranges[link]).then(() => { chart.following = false; });
    }
    chart.on("plotly_relayout", (change) => { if (!chart.following) linked(chart, change); });
    chart.on("plotly_hover", (pointed) => document.dispatchEvent(
      new CustomEvent("pointed", { detail: { link, at: pointed.xvals ? pointed.xvals[0] : pointed.points[0].x } })));
  });
  document.addEventListener("shown", () => {
    if (!window.Plotly) return;
    draw();
    charts.filter((chart) => !chart.closest("[hidden]")).forEach((chart) => Plotly.Plots.resize(chart));
  });
  // The library is in the page, packed; unpacking is the browser's own.
  const unpack = async () => {
    const packed = Uint8Array.from(atob(document.getElementById("library").textContent), (c) => c.charCodeAt(0));
    const source = new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip")));
    const script = document.createElement("script");
    script.textContent = await source.text();
    document.head.append(script);
    draw();
  };
  unpack().catch((error) => document.querySelectorAll(".chart").forEach((chart) => {
    chart.style.height = "auto";
    chart.textContent = "This figure needs a browser of 2023 or later (" + error + "). The data are beside this page.";
  }));
  dark.addEventListener("change", () => colour(dark.matches));
  window.addEventListener("beforeprint", () => colour(false));
  window.addEventListener("afterprint", () => colour(dark.matches));
})();
