"use strict";
// Without this script all steps are there to be opened. With it one is shown at a time.
let current = null;
for (const section of document.querySelectorAll(".exploration")) {
  const replay = section.querySelector(".replay");
  const slider = replay.querySelector("input");
  const box = replay.querySelector(".side .scroll");
  const steps = [...replay.querySelectorAll("details[data-step]")];
  const last = steps.length - 1;
  const now = section.querySelector(".now");

  const show = (wanted) => {
    const step = Math.min(last, Math.max(0, wanted));
    slider.value = step;
    steps.forEach((details, number) => {
      details.parentElement.hidden = number !== step;
      details.open = number === step;
    });
    for (const row of section.querySelectorAll("tr[data-step]")) {
      if (row.dataset.step === String(step)) row.setAttribute("aria-current", "step");
      else row.removeAttribute("aria-current");
    }
    const row = box.querySelector("tr[aria-current]");
    box.scrollTop = row.offsetTop - (box.clientHeight - row.offsetHeight) / 2;
    const words = steps[step].querySelector("summary").textContent;
    slider.setAttribute("aria-valuetext", words);
    replay.querySelector(".which").textContent = step;
    replay.querySelector(".says").textContent = words;
    const x = (now.dataset.to * step) / Math.max(1, last);
    now.setAttribute("transform", `translate(${x} 0)`);
    const at = { first: 0, back: 0, next: last, last: last };
    for (const button of replay.querySelectorAll("button")) {
      button.setAttribute("aria-disabled", step === at[button.dataset.go]);
    }
  };
  const go = (where) => {
    const step = Number(slider.value);
    current = go;
    show({ first: 0, back: step - 1, next: step + 1, last: last }[where]);
  };

  slider.addEventListener("input", () => {
    current = go;
    show(Number(slider.value));
  });
  for (const button of replay.querySelectorAll("button")) {
    button.addEventListener("click", () => go(button.dataset.go));
  }
  replay.addEventListener("keydown", (event) => {
    const where = { Home: "first", End: "last" }[event.key];
    if (where && event.target.matches("button")) {
      event.preventDefault();
      go(where);
    }
  });
  window.addEventListener("resize", () => show(Number(slider.value))); // the log's line moves
  section.classList.add("played");
  replay.querySelector(".player").hidden = false;
  show(0);
  current ??= go;  // the first one
}
// The arrow keys move the replay that was used last, but where they have another meaning.
document.addEventListener("keydown", (event) => {
  const where = { ArrowLeft: "back", ArrowRight: "next" }[event.key];
  if (!where || !current || event.altKey || event.ctrlKey || event.metaKey) return;
  if (event.target.matches("input, .scroll")) return;
  event.preventDefault();
  current(where);
});
