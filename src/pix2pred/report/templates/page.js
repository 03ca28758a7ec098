"use strict";
(() => {
const $ = (id) => document.getElementById(id);
const data = JSON.parse($("data").textContent);
const VALUE = { "1": ["t", "T", "true"], "0": ["f", "F", "false"], "?": ["u", "?", "unknown"] };
const near = new Set(["selected", "given", "runner-up", "same", "dropped"]);
const own = (map, key) => (Object.hasOwn(map, key) ? map[key] : undefined); /* "constructor" may be a name, too */
const page = { data, tables: new Map(), current: null, el, say, own, valueWord: (v) => VALUE[v][2] };
window.pix2pred = page;

function el(name, attributes, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes || {})) {
    if (value === null || value === undefined || value === false) continue;
    if (key === "class") node.className = value; else node.setAttribute(key, value === true ? "" : value);
  }
  for (const child of children) if (child !== null && child !== undefined) node.append(child);
  return node;
}
function svg(name, attributes, ...children) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}
function say(text) { $("said").textContent = text; }

/* Pictures, one a line, come last in the page, so that tables need not wait for them. */
let uris = null;
function embed(node, attribute, number, otherwise) {
  if (document.readyState === "loading") { document.addEventListener("DOMContentLoaded", () => embed(node, attribute, number, otherwise), { once: true }); return; }
  uris ??= $("pictures").textContent.split("\n");
  if (uris[number]) node.setAttribute(attribute, uris[number]); else otherwise();
}

for (const demo of data.demos) {
  demo.names = demo.atoms.map(([p, ...objects]) => objects.map((o) => demo.objects[o][0]));
  demo.index = new Map(demo.atoms.map(([p], i) => [[data.predicates[p].name, ...demo.names[i]].join(" "), i]));
}
page.predicateName = (p) => (own(data.corrections.names, data.predicates[p].name) || data.predicates[p].name);
page.atomText = (d, row) => `${page.predicateName(data.demos[d].atoms[row][0])}(${data.demos[d].names[row].join(", ")})`;
const doubted = new Map();
for (const s of data.suspicions) {
  const d = data.demos.findIndex((demo) => demo.name === s.demo);
  const row = d < 0 ? undefined : data.demos[d].index.get(s.atom.join(" "));
  if (row !== undefined) for (const [state, , likely, p] of s.doubts) doubted.set(`${d} ${row} ${state}`, { likely, p, reasons: s.reasons });
}
page.doubted = doubted;
page.label = (d, row, state) => data.demos[d].labels[row][state];
page.said = (d, row, state) => (data.demos[d].said[row] || data.demos[d].labels[row])[state];

function wanted(predicate) {
  const text = $("search").value.trim().toLowerCase();
  const name = (own(data.corrections.names, predicate.name) || predicate.name).toLowerCase();
  if (text) return name.includes(text) || predicate.name.toLowerCase().includes(text);
  const filter = $("filter").value;
  if (filter === "all") return true;
  if (filter === "near") return near.has(predicate.status);
  return predicate.given || predicate.status === "selected";
}

function header(d) {
  const demo = data.demos[d];
  const row = el("tr", {}, el("th", { scope: "col" }, "atom \\ state"));
  for (let t = 0; t < demo.labels[0]?.length || t <= demo.actions.length; t++) {
    if (t > demo.actions.length) break;
    const action = t ? demo.actions[t - 1].text : null;
    const words = el("span", { class: "action" });
    if (action) { const cut = action.indexOf("("); words.append("→ ", el("b", {}, action.slice(0, cut)), action.slice(cut)); } else words.append("start");
    const picture = demo.states[t]?.[0], image = picture && el("img", { alt: "", loading: "lazy", decoding: "async" });
    if (picture) embed(image, "src", picture.picture, () => image.remove());
    const button = el("button", { type: "button", "aria-label": `Show state ${t} of ${demo.name}`, tabindex: t ? "-1" : null }, image);
    button.addEventListener("click", () => showState(d, t));
    row.append(el("th", { scope: "col", id: `d${d}-s${t}`, "data-state": t }, words, button, el("span", { class: "state" }, `state ${t}`)));
  }
  return el("thead", {}, row);
}

function cellInto(td, d, row, t) {
  const value = page.label(d, row, t), [cls, letter, word] = VALUE[value];
  const corrected = page.said(d, row, t) !== value, doubt = doubted.get(`${d} ${row} ${t}`);
  td.className = cls + (corrected ? " corrected" : "") + (doubt ? " doubted" : "");
  td.textContent = letter;
  td.setAttribute("aria-label", `${page.atomText(d, row)}, state ${t}: ${word}` +
    (corrected ? `, corrected; the model said ${VALUE[page.said(d, row, t)][2]}` : "") +
    (doubt && !corrected ? `, doubted: likely ${VALUE[doubt.likely][2]}` : ""));
}

function body(d) {
  const demo = data.demos[d], tbody = el("tbody");
  let predicate = -1, columns = demo.actions.length + 1;
  const constant = $("constant").checked;
  demo.atoms.forEach(([p], row) => {
    if (!wanted(data.predicates[p]) || !(constant || /[1?]/.test(demo.labels[row] + (demo.said[row] || "")))) return;
    if (p !== predicate) {
      predicate = p;
      const entry = data.predicates[p], title = el("span", {}, page.predicateName(p),
        el("span", { class: "dim" }, `${entry.types.join(", ")} · ${entry.given ? "given" : entry.status}`));
      if (data.review && !entry.given) page.predicateTools?.(title, p);
      tbody.append(el("tr", { class: "group" }, el("th", { scope: "rowgroup", colspan: columns + 1 }, title)));
    }
    const name = `(${demo.names[row].join(", ")})`;
    const tr = el("tr", { class: "row", "data-row": row }, el("th", { scope: "row", title: page.atomText(d, row) },
      el("span", { class: "visually-hidden" }, page.predicateName(p)), name));
    for (let t = 0; t < columns; t++) {
      const td = el("td", { tabindex: "-1", "data-state": t });
      cellInto(td, d, row, t);
      tr.append(td);
    }
    tbody.append(tr);
  });
  if (!tbody.children.length) tbody.append(el("tr", {}, el("td", { colspan: columns + 1 }, "no predicate of this name")));
  return tbody;
}

function draw(d) {
  const details = $(`d${d}`), holder = details.querySelector(".demo-body"), demo = data.demos[d];
  const old = page.tables.get(d);
  if (old) { old.table.replaceChild(body(d), old.table.tBodies[0]); first(d); return; }
  const table = el("table", { class: "truth" }, el("caption", {}, `Truth table of ${demo.name}: atoms by state`), header(d), body(d));
  const panel = el("aside", { class: "panel", "aria-label": `Picture and explanation, ${demo.name}` });
  const scroll = el("div", { class: "truth-scroll" }, table);
  const further = el("button", { type: "button", class: "further", tabindex: "-1" }, "further states →");
  further.addEventListener("click", () => scroll.scrollBy({ left: scroll.clientWidth * 0.7, behavior: "smooth" }));
  const more = () => { further.hidden = scroll.scrollLeft + scroll.clientWidth >= scroll.scrollWidth - 2; };
  scroll.addEventListener("scroll", more, { passive: true });
  new ResizeObserver(more).observe(scroll);
  holder.append(scroll, panel, further);
  page.tables.set(d, { table, panel });
  table.addEventListener("focusin", (e) => { const c = place(e.target); if (c) select(d, c.row, c.state, e.target); });
  table.addEventListener("mouseover", (e) => { const c = place(e.target); if (c) show(d, c.row, c.state); });
  table.addEventListener("mouseleave", () => { if (page.current?.d === d) show(d, page.current.row, page.current.state); });
  table.addEventListener("keydown", (e) => keys(e, d));
  first(d);
  showState(d, 0);
}
function first(d) { const td = page.tables.get(d).table.querySelector("td[data-state]"); if (td) td.tabIndex = 0; }
function place(target) {
  const td = target.closest?.("td[data-state]");
  return td ? { row: +td.parentNode.dataset.row, state: +td.dataset.state } : null;
}
page.place = place;
page.cell = (d, row, t) => page.tables.get(d)?.table.querySelector(`tr[data-row="${row}"] td[data-state="${t}"]`) || null;
page.refresh = (d, row, t) => {
  const td = page.cell(d, row, t);
  if (td) cellInto(td, d, row, t);
  if (page.current && page.current.d === d && page.current.row === row && page.current.state === t) show(d, row, t);
};
page.redraw = () => { for (const d of page.tables.keys()) draw(d); };

function select(d, row, state, td) {
  page.current = { d, row, state };
  for (const other of page.tables.get(d).table.querySelectorAll('td[tabindex="0"]')) other.tabIndex = -1;
  td.tabIndex = 0;
  show(d, row, state);
}
function keys(e, d) {
  const td = e.target.closest?.("td[data-state]");
  if (!td || e.ctrlKey || e.metaKey || e.altKey) return;
  const rows = [...page.tables.get(d).table.querySelectorAll("tr.row")];
  let r = rows.indexOf(td.parentNode), t = +td.dataset.state;
  const last = data.demos[d].actions.length;
  const moves = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0], PageUp: [-10, 0], PageDown: [10, 0] };
  if (e.key in moves) { r += moves[e.key][0]; t += moves[e.key][1]; }
  else if (e.key === "Home") t = 0;
  else if (e.key === "End") t = last;
  else { if (page.keyOnCell?.(e, d, +td.parentNode.dataset.row, t)) e.preventDefault(); return; }
  e.preventDefault();
  r = Math.max(0, Math.min(rows.length - 1, r)); t = Math.max(0, Math.min(last, t));
  const next = rows[r].querySelector(`td[data-state="${t}"]`);
  next.focus({ preventScroll: true });
  reveal(next);
}
function reveal(td) {
  const box = td.closest(".truth-scroll"), a = td.getBoundingClientRect(), b = box.getBoundingClientRect();
  const head = box.querySelector("thead").getBoundingClientRect().height, side = 250;
  if (a.top < b.top + head) box.scrollTop -= b.top + head - a.top + 6; else if (a.bottom > b.bottom) box.scrollTop += a.bottom - b.bottom + 14;
  if (a.left < b.left + side) box.scrollLeft -= b.left + side - a.left + 6; else if (a.right > b.right) box.scrollLeft += a.right - b.right + 14;
  const again = td.getBoundingClientRect();
  if (again.top < 0 || again.bottom > innerHeight) td.scrollIntoView({ block: "center" });
}

function drawing(picture, objects, crop) {
  const [w, h] = picture.size, image = svg("image", { x: 0, y: 0, width: w, height: h, preserveAspectRatio: "none" });
  const view = crop ? [crop[0], crop[1], crop[2] - crop[0], crop[3] - crop[1]] : [0, 0, w, h];
  const figure = svg("svg", { class: "picture", viewBox: view.join(" "), role: "img", tabindex: "0", "aria-label": objects.length ? `picture with ${objects.join(", ")} framed` : "picture" });
  figure.append(image);
  embed(image, "href", picture.picture, () => {
    const t = svg("text", { x: w / 2, y: h / 2, "text-anchor": "middle" });
    t.textContent = "no picture stored";
    image.replaceWith(t);
  });
  for (const name of objects) {
    const box = own(picture.boxes, name);
    if (!box) continue;
    figure.append(svg("rect", { class: "object", x: box[0], y: box[1], width: box[2] - box[0], height: box[3] - box[1], rx: 3 }));
    const t = svg("text", { x: box[0] + 3, y: Math.max(view[1] + 14, box[1] - 5) });
    t.textContent = name;
    t.style.fontSize = `${(crop ? view[2] : w) / 22}px`;
    figure.append(t);
  }
  return figure;
}
function pictures(panel, d, t, objects) {
  const demo = data.demos[d];
  for (const picture of demo.states[t] || []) {
    panel.append(el("figure", {}, drawing(picture, objects, null), el("figcaption", {}, `state ${t}, camera ${picture.camera}`)));
    if (picture.crop) panel.append(el("figure", {}, drawing(picture, objects, picture.crop), el("figcaption", {}, `around ${demo.actions[t - 1].text}`)));
  }
}
function mark(d, t) {
  for (const th of page.tables.get(d).table.tHead.querySelectorAll("th")) th.classList.toggle("at", th.dataset.state === String(t));
}
function show(d, row, t) {
  const { panel } = page.tables.get(d), demo = data.demos[d], p = data.predicates[demo.atoms[row][0]];
  const value = page.label(d, row, t), said = page.said(d, row, t), doubt = doubted.get(`${d} ${row} ${t}`);
  panel.replaceChildren();
  panel.append(el("h3", {}, page.atomText(d, row)));
  const [cls, , word] = VALUE[value];
  panel.append(el("p", { class: "value" }, el("span", { class: `badge ${cls === "t" ? "yes" : cls === "f" ? "no" : ""}` }, word), ` in state ${t}`));
  if (value !== said) panel.append(el("p", { class: "dim" }, `Corrected; the model said ${VALUE[said][2]}.`));
  if (doubt) panel.append(el("p", { class: "dim" }, `Doubted: ${VALUE[doubt.likely][2]} with probability ${Math.round(100 * doubt.p)} %${doubt.reasons.length ? " (" + doubt.reasons.join(", ") + ")" : ""}.`));
  page.cellTools?.(panel, d, row, t);
  const why = demo.why[row]?.[t];
  if (why !== undefined && why >= 0) panel.append(el("blockquote", {}, data.explanations[why]));
  else panel.append(el("p", { class: "dim" }, p.source === "vlm" ? "The model gave no explanation." : `Not asked of the model: source ${p.source}.`));
  pictures(panel, d, t, demo.names[row]);
  mark(d, t);
}
function showState(d, t) {
  const { panel } = page.tables.get(d), demo = data.demos[d];
  panel.replaceChildren(el("h3", {}, `${demo.name}, state ${t}`),
    el("p", { class: "dim" }, t ? `after ${demo.actions[t - 1].text}` : "before the first skill"));
  pictures(panel, d, t, t ? demo.actions[t - 1].objects.map((o) => demo.objects[o][0]) : demo.objects.map((o) => o[0]));
  mark(d, t);
}

page.goto = (d, t, row) => {
  const details = $(`d${d}`);
  details.open = true;
  if (!page.tables.has(d)) draw(d);
  if (row !== undefined && !page.cell(d, row, t)) { $("search").value = ""; $("filter").value = wantsAll(d, row); $("constant").checked ||= !/[1?]/.test(data.demos[d].labels[row]); page.redraw(); }
  details.scrollIntoView({ block: "start" });
  const td = row === undefined ? null : page.cell(d, row, t);
  if (td) { td.focus({ preventScroll: true }); reveal(td); }
  else { showState(d, t); $(`d${d}-s${t}`)?.scrollIntoView({ block: "nearest", inline: "center" }); }
};
function wantsAll(d, row) { return near.has(data.predicates[data.demos[d].atoms[row][0]].status) ? "near" : "all"; }

/* Nothing of what was labelled was selected: everything is shown instead of nothing. */
if (!data.predicates.some((p) => p.status === "selected")) $("filter").value = "all";

for (const shot of document.querySelectorAll(".shot[data-picture]")) {
  const image = el("img", { alt: shot.dataset.text, loading: "lazy", decoding: "async", tabindex: "0", role: "button" });
  embed(image, "src", +shot.dataset.picture, () => { image.remove(); shot.textContent = "no picture stored"; });
  shot.append(image);
}
/* A click, or Enter, enlarges a picture; the next one closes it. */
const zoom = el("dialog", { class: "zoom", "aria-label": "Picture, enlarged" });
document.body.append(zoom);
zoom.addEventListener("click", () => zoom.close());
function enlarge(target) {
  const picture = target.closest?.("svg.picture, .shot img");
  if (!picture || zoom.contains(picture)) return false;
  const copy = picture.cloneNode(true);
  copy.removeAttribute("tabindex");
  zoom.replaceChildren(copy, el("p", { class: "dim" }, picture.getAttribute("alt") || picture.getAttribute("aria-label") || ""));
  zoom.showModal();
  return true;
}
document.addEventListener("click", (e) => enlarge(e.target));
document.addEventListener("keydown", (e) => { if (e.key === "Enter" && enlarge(e.target)) e.preventDefault(); });

for (const details of document.querySelectorAll("details.demo")) {
  const d = +details.dataset.demo;
  if (details.open) draw(d);
  details.addEventListener("toggle", () => { if (details.open && !page.tables.has(d)) draw(d); });
}
document.addEventListener("click", (e) => {
  const link = e.target.closest?.("a[data-demo]");
  if (!link) return;
  e.preventDefault();
  const d = +link.dataset.demo;
  page.goto(d, +link.dataset.state, link.dataset.atom === undefined ? undefined : data.demos[d].index.get(link.dataset.atom));
});
let timer = 0;
$("filter").addEventListener("change", page.redraw);
$("constant").addEventListener("change", page.redraw);
$("search").addEventListener("input", () => { clearTimeout(timer); timer = setTimeout(page.redraw, 120); });
for (const node of document.querySelectorAll("svg .node")) {
  const light = (on) => () => { for (const l of document.querySelectorAll(".link")) l.classList.toggle("lit", on && (l.dataset.source === node.dataset.node || l.dataset.target === node.dataset.node)); };
  for (const event of ["mouseenter", "focus"]) node.addEventListener(event, light(true));
  for (const event of ["mouseleave", "blur"]) node.addEventListener(event, light(false));
}
/* What is further down is laid out when the page is there and nobody waits. */
const later = [...document.querySelectorAll("section.later")], idle = window.requestIdleCallback || setTimeout;
function layOut() { const section = later.shift(); if (section) { section.classList.remove("later"); idle(layOut); } }
addEventListener("load", () => idle(layOut));
const links = new Map([...document.querySelectorAll("nav a")].map((a) => [a.getAttribute("href").slice(1), a]));
const watcher = new IntersectionObserver((entries) => {
  for (const entry of entries) if (entry.isIntersecting) for (const [id, a] of links) a.classList.toggle("here", id === entry.target.id);
}, { rootMargin: "-10% 0px -80% 0px" });
for (const id of links.keys()) if ($(id)) watcher.observe($(id));
})();
