"use strict";

// Numbers by their value, texts by the order of their words and numbers; what has no value stays last.
function compareCells(a, b, numeric, sign) {
  const [x, y] = [a.dataset.value, b.dataset.value];
  if (x === "" || y === "") return (x === "") - (y === "");
  return sign * (numeric ? Number(x) - Number(y) : x.localeCompare(y, "en", {numeric: true}));
}

function sortBy(header) {
  const table = header.closest("table");
  const body = table.tBodies[0];
  const column = header.cellIndex;
  const ascending = header.getAttribute("aria-sort") !== "ascending";
  for (const other of header.parentElement.cells) other.setAttribute("aria-sort", "none");
  header.setAttribute("aria-sort", ascending ? "ascending" : "descending");
  const rows = Array.from(body.rows);
  const numeric = rows.some((row) => row.cells[column].classList.contains("number"));
  rows.sort((a, b) => compareCells(a.cells[column], b.cells[column], numeric, ascending ? 1 : -1));
  body.append(...rows);
}

for (const button of document.querySelectorAll("table.sortable th button")) {
  button.addEventListener("click", () => sortBy(button.closest("th")));
}

for (const viewer of document.querySelectorAll(".viewer")) {
  const choices = viewer.querySelectorAll(".choice");
  const select = viewer.querySelector("select");
  const show = () => choices.forEach((choice, i) => { choice.hidden = select && i !== select.selectedIndex; });
  if (select) select.addEventListener("change", show);
  show();
  for (const slider of viewer.querySelectorAll("input[type=range]")) {
    const stage = slider.closest(".choice").querySelector(".stage");
    const move = () => stage.style.setProperty("--at", `${slider.value}%`);
    slider.addEventListener("input", move);
    const follow = (event) => {
      if (event.buttons !== 1) return;
      const box = stage.getBoundingClientRect();
      slider.value = Math.round(100 * (event.clientX - box.left) / box.width);
      move();
    };
    stage.addEventListener("pointerdown", follow);
    stage.addEventListener("pointermove", follow);
    move();
  }
}
