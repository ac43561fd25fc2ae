// A slider that uncovers the input over pictures made from it; without scripts nothing is missing.
(() => {
  const before = document.querySelector("img[data-compare=before]");
  if (!before) return;
  for (const after of document.querySelectorAll("img[data-compare=after]")) {
    const box = document.createElement("div");
    box.className = "compare";
    after.replaceWith(box);
    const over = document.createElement("img");
    Object.assign(over, { src: before.src, alt: "", className: "picture" });
    const slider = document.createElement("input");
    Object.assign(slider, { type: "range", min: 0, max: 100, value: 0 });
    const label = document.createElement("label");
    label.append("uncover the input", slider);
    const cut = () => box.style.setProperty("--cut", `${100 - slider.value}%`);
    slider.addEventListener("input", cut);
    cut();
    box.append(after, over);
    box.after(label);
  }
})();
