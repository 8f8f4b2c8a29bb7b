// Draws every figure of the page from the data beside it, in the page's colours, and zooms linked figures together.
"use strict";
(() => {
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const template = (night) => {
    const ink = night ? "#e3e8ee" : "#1c2430", grid = night ? "#313a46" : "#dfe4ea", clear = "rgba(0,0,0,0)";
    const axis = { gridcolor: grid, zerolinecolor: night ? "#4a5666" : "#b9c2cc", linecolor: grid, ticks: "outside", tickcolor: grid,
                   showspikes: true, spikemode: "across", spikethickness: 1, spikecolor: "#888888", spikedash: "dot" };
    const plain = { ...axis, showspikes: false, backgroundcolor: clear };
    return { layout: {
      font: { color: ink, size: 12, family: "system-ui, sans-serif" }, paper_bgcolor: clear, plot_bgcolor: clear,
      margin: { l: 64, r: 16, t: 34, b: 46 }, xaxis: axis, yaxis: axis, scene: { xaxis: plain, yaxis: plain, zaxis: plain },
      legend: { orientation: "h", x: 0, y: 1, yanchor: "bottom", xanchor: "left" }, hoverlabel: { namelength: -1, bgcolor: night ? "#232a33" : "#ffffff", font: { color: ink } },
      modebar: { bgcolor: clear, color: "#98a4b3", activecolor: "#2b7bbd" }, annotationdefaults: { font: { color: ink } },
    } };
  };
  const configuration = { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["lasso2d", "select2d"],
                          toImageButtonOptions: { format: "svg" } };
  const charts = [];
  const linked = (source, change) => {
    const range = change["xaxis.range[0]"] !== undefined
      ? { "xaxis.range": [change["xaxis.range[0]"], change["xaxis.range[1]"]] }
      : change["xaxis.range"] ? { "xaxis.range": change["xaxis.range"] }
      : change["xaxis.autorange"] ? { "xaxis.autorange": true } : null;
    if (!range) return;
    for (const chart of charts) {
      if (chart === source || chart.dataset.link !== source.dataset.link) continue;
      chart.following = true;
      Plotly.relayout(chart, range).then(() => { chart.following = false; });
    }
  };
  const colour = (night) => charts.forEach((chart) => Plotly.relayout(chart, { template: template(night) }));

  for (const chart of document.querySelectorAll(".chart")) {
    const drawing = JSON.parse(document.getElementById(chart.id + "-data").textContent);
    drawing.layout.template = template(dark.matches);
    Plotly.newPlot(chart, drawing.data, drawing.layout, configuration);
    charts.push(chart);
    if (chart.dataset.link) chart.on("plotly_relayout", (change) => { if (!chart.following) linked(chart, change); });
  }
  dark.addEventListener("change", () => colour(dark.matches));
  window.addEventListener("beforeprint", () => colour(false));
  window.addEventListener("afterprint", () => colour(dark.matches));
})();
