// Pictures open large, and a slider uncovers the input over pictures made from it; without scripts
// nothing is missing.
(() => {
  const make = (tag, properties) => Object.assign(document.createElement(tag), properties);

  const large = make("img", { alt: "" });
  const words = make("p", {});
  const close = make("button", { type: "button", textContent: "Close" });
  const dialog = make("dialog", {});
  dialog.addEventListener("click", () => dialog.close());
  document.body.append(dialog);
  for (const picture of document.querySelectorAll("img.picture")) {
    const open = () => {
      large.src = picture.src;
      words.textContent = large.alt = picture.alt;
      large.className = picture.classList.contains("hatched") ? "hatched" : "";
      dialog.append(large, words, close);
      dialog.showModal();
    };
    Object.assign(picture, { tabIndex: 0, role: "button", title: "Open large" });
    picture.addEventListener("click", open);
    picture.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      open();
    });
  }

  const before = document.querySelector("img[data-compare=before]");
  if (!before) return;
  for (const after of document.querySelectorAll("img[data-compare=after]")) {
    const box = make("div", { className: "compare" });
    after.replaceWith(box);
    const over = make("img", { src: before.src, alt: "", className: "picture" });
    const slider = make("input", { type: "range", min: 0, max: 100, value: 0 });
    const label = make("label", {});
    label.append("uncover the input", slider);
    const cut = () => box.style.setProperty("--cut", `${100 - slider.value}%`);
    slider.addEventListener("input", cut);
    cut();
    box.append(after, over);
    box.after(label);
  }
})();
