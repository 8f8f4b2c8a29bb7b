// What a page has besides its figures: choices of which one is shown, topics that a drawing selects, and drawings that move.
"use strict";
(() => {
  const shown = () => document.dispatchEvent(new CustomEvent("shown"));

  document.querySelectorAll(".choice").forEach((choice) => {
    const options = choice.querySelectorAll(":scope > .option");
    choice.addEventListener("change", (event) => {
      options.forEach((option, index) => { option.hidden = index !== Number(event.target.value); });
      shown();
    });
  });

  // A click on a place of a drawing hides what is about other places; a second click shows everything.
  const places = [...document.querySelectorAll("svg [data-topic]")];
  const items = [...document.querySelectorAll("div[data-topic]")];
  const topics = (item) => item.dataset.topic.split(" ");
  let selected = null;
  const note = document.createElement("p");
  note.className = "selected";
  note.setAttribute("role", "status");
  const select = (topic) => {
    selected = topic === selected ? null : topic;
    items.forEach((item) => { item.hidden = selected !== null && !topics(item).includes(selected); });
    places.forEach((place) => {
      place.classList.toggle("selected", place.dataset.topic === selected);
      place.setAttribute("aria-pressed", String(place.dataset.topic === selected));
    });
    note.textContent = selected === null ? "" : `Only what is about ${selected} is shown. Click it again to see everything.`;
    shown();
  };
  places.filter((place) => items.some((item) => topics(item).includes(place.dataset.topic))).forEach((place) => {
    place.classList.add("selectable");
    place.setAttribute("tabindex", "0");
    place.setAttribute("role", "button");
    place.setAttribute("aria-label", `show only ${place.dataset.topic}`);
    place.addEventListener("click", () => select(place.dataset.topic));
    place.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      select(place.dataset.topic);
    });
    place.closest("figure").after(note);
  });

  document.querySelectorAll(".scene").forEach((scene) => {
    const { at, parts, lamps } = JSON.parse(document.getElementById(scene.id + "-data").textContent);
    const slider = scene.querySelector("input"), time = scene.querySelector("output"), button = scene.querySelector("button");
    const all = (kind, name) => [...scene.querySelectorAll(`[data-${kind}="${name}"]`)];
    const moving = Object.entries(parts).map(([name, places]) => [all("part", name), places]);
    const lights = Object.entries(lamps).map(([name, states]) => [all("lamp", name), states]);
    const show = (index) => {
      for (const [elements, places] of moving) {
        const [x, y, angle] = places[index];
        elements.forEach((element) => element.setAttribute("transform", `translate(${x} ${y}) rotate(${angle})`));
      }
      for (const [elements, states] of lights) {
        elements.forEach((element) => element.classList.toggle("on", states[index] === "1"));
      }
      slider.value = index;
      time.value = at[index].toFixed(2);
    };
    if (at.length === 0) return;
    let timer = null;
    const stop = () => { clearInterval(timer); timer = null; button.textContent = "Play"; };
    button.addEventListener("click", () => {
      if (timer !== null) { stop(); return; }
      button.textContent = "Pause";
      const first = Number(slider.value) < at.length - 1 ? Number(slider.value) : 0;
      const begun = performance.now();
      timer = setInterval(() => {
        const now = at[first] + (performance.now() - begun) / 1000;
        const index = at.findIndex((instant) => instant >= now);
        if (index < 0) { show(at.length - 1); stop(); } else show(index);
      }, 40);
    });
    slider.addEventListener("input", () => { stop(); show(Number(slider.value)); });
    document.addEventListener("pointed", (event) => {
      if (event.detail.link !== scene.dataset.link || timer !== null) return;
      const index = at.findIndex((instant) => instant >= event.detail.at);
      show(index < 0 ? at.length - 1 : index);
    });
    show(Number(slider.value));
  });
})();
