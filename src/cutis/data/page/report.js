// A slider over two pictures that the page shows anyway; without scripts nothing is missing.
(() => {
  const place = document.getElementById("compare");
  const [before, after] = ["before", "after"].map((side) =>
    document.querySelector(`img[data-compare="${side}"]`));
  if (!place || !before || !after) return;
  const box = document.createElement("div");
  box.className = "compare";
  for (const picture of [before, after]) {
    const copy = document.createElement("img");
    copy.src = picture.src;
    copy.alt = "";
    box.append(copy);
  }
  const words = document.createElement("p");
  words.className = "quiet";
  for (const text of [place.dataset.before, place.dataset.after]) {
    words.append(Object.assign(document.createElement("span"), { textContent: text }));
  }
  const slider = document.createElement("input");
  Object.assign(slider, { type: "range", min: 0, max: 100, value: 50 });
  slider.setAttribute("aria-label",
    `Share of the width that shows ${place.dataset.before}; the rest shows ${place.dataset.after}`);
  const cut = () => box.style.setProperty("--cut", `${slider.value}%`);
  slider.addEventListener("input", cut);
  cut();
  box.append(slider, words);
  place.append(box);
})();
