"use strict";
(() => {
const page = window.pix2pred, { data, el, say, own } = page, $ = (id) => document.getElementById(id);
const LETTER = { true: "1", false: "0", unknown: "?" }, WORD = { "1": "true", "0": "false", "?": "unknown" };
document.body.classList.add("review");
let version = null, sending = Promise.resolve();

async function ask(path, body) {
  const answer = await fetch(path, body === undefined ? {} : { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
  const text = await answer.text();
  let got;
  try { got = JSON.parse(text); } catch { throw new Error(text || `the server answered ${answer.status}`); }
  if (got.corrections) take(got);
  if (!answer.ok) throw new Error(got.error);
  return got;
}
function send(rows, text) {
  sending = sending.then(() => ask("corrections", rows)).then(() => say(text + ", saved"), fail);
  return sending;
}
function fail(error) {
  const gone = error instanceof TypeError;
  $("learning").textContent = gone ? "The server does not answer; nothing more is saved until it does." : `Not saved: ${error.message}`;
  $("learning").className = "error";
  say($("learning").textContent);
}

function take(state) {
  const before = data.corrections, now = state.corrections;
  data.corrections = now;
  const touched = new Map();
  for (const [demo, t, atom] of before.labels) touched.set(JSON.stringify([demo, t, atom]), null);
  for (const [demo, t, atom, label] of now.labels) touched.set(JSON.stringify([demo, t, atom]), LETTER[label]);
  for (const [key, letter] of touched) {
    const [demo, t, atom] = JSON.parse(key), d = data.demos.findIndex((x) => x.name === demo);
    const row = d < 0 ? undefined : data.demos[d].index.get(atom.join(" "));
    if (row === undefined) continue;
    const x = data.demos[d], said = page.said(d, row, t), value = letter ?? said;
    if (x.labels[row][t] === value) continue;
    x.said[row] ??= x.labels[row];
    x.labels[row] = x.labels[row].slice(0, t) + value + x.labels[row].slice(t + 1);
    page.refresh(d, row, t);
  }
  if (JSON.stringify([before.names, before.merged, before.standing]) !== JSON.stringify([now.names, now.merged, now.standing])) keepFocus(page.redraw);
  const waiting = now.count - data.learned;
  $("waiting").textContent = waiting > 0 ? `${waiting} correction${waiting > 1 ? "s" : ""} not yet learned with` : "Everything is learned with.";
  $("learn").disabled = Boolean(state.learning.running);
  if (state.learning.running) { $("learning").className = "status"; $("learning").textContent = state.learning.running; }
  else if (state.learning.error) { $("learning").className = "error"; $("learning").textContent = state.learning.error; }
  else if ($("learning").className === "status") $("learning").textContent = "";
  if (version !== null && state.learning.version !== version) { remember(); location.reload(); }
  version = state.learning.version;
}
function keepFocus(action) {
  const c = page.current, inside = document.activeElement?.closest?.("td[data-state], tr.group button");
  action();
  if (inside && c) page.cell(c.d, c.row, c.state)?.focus({ preventScroll: true });
}
function remember() {
  const open = [...document.querySelectorAll("details.demo[open]")].map((x) => +x.dataset.demo);
  sessionStorage.setItem("pix2pred", JSON.stringify({ open, filter: $("filter").value, search: $("search").value, y: scrollY }));
}

function labelRow(d, row, t, value) {
  const demo = data.demos[d];
  return { kind: "label", demo: demo.name, state: t, atom: [data.predicates[demo.atoms[row][0]].name, ...demo.names[row]], old: WORD[page.label(d, row, t)], new: WORD[value] };
}
function put(d, row, t, value) {
  if (page.label(d, row, t) === value) return;
  send([labelRow(d, row, t, value)], `${page.atomText(d, row)} in state ${t} is ${WORD[value]}`);
}
const flipped = (d, row, t) => (page.label(d, row, t) === "1" ? "0" : "1");

page.keyOnCell = (e, d, row, t) => {
  const key = e.key.toLowerCase();
  if (key === " " || key === "enter") put(d, row, t, flipped(d, row, t));
  else if (key === "u") put(d, row, t, "?");
  else if (key === "t") put(d, row, t, "1");
  else if (key === "f") put(d, row, t, "0");
  else if (key === "x") put(d, row, t, page.said(d, row, t));
  else if (key === "n") next(d, row, t);
  else return false;
  return true;
};
document.addEventListener("click", (e) => {
  const td = e.target.closest?.("td[data-state]"), c = td && page.place(td);
  if (c) { const d = +td.closest("details.demo").dataset.demo; td.focus({ preventScroll: true }); put(d, c.row, c.state, flipped(d, c.row, c.state)); }
});
function next(d, row, t) {
  const places = [];
  for (const s of data.suspicions) {
    const i = data.demos.findIndex((x) => x.name === s.demo), r = data.demos[i]?.index.get(s.atom.join(" "));
    if (r !== undefined) for (const [state] of s.doubts) places.push([i, r, state]);
  }
  if (!places.length) { say("no label is doubted"); return; }
  const here = places.findIndex(([i, r, s]) => i === d && r === row && s === t);
  const [i, r, s] = places[(here + 1) % places.length];
  page.goto(i, s, r);
}

page.cellTools = (panel, d, row, t) => {
  const value = page.label(d, row, t), group = el("div", { class: "buttons", role: "group", "aria-label": "Set this label" });
  for (const [letter, text] of [["1", "True"], ["0", "False"], ["?", "Unknown"]]) {
    const button = el("button", { type: "button", "aria-pressed": String(value === letter) }, text);
    button.addEventListener("click", () => put(d, row, t, letter));
    group.append(button);
  }
  if (page.said(d, row, t) !== value) {
    const back = el("button", { type: "button" }, "As the model said");
    back.addEventListener("click", () => put(d, row, t, page.said(d, row, t)));
    group.append(back);
  }
  panel.append(group);
};
page.predicateTools = (title, p) => {
  const entry = data.predicates[p], standing = own(data.corrections.standing, entry.name) || "free", merged = own(data.corrections.merged, entry.name);
  const tool = (text, action, pressed, describe) => {
    const button = el("button", { type: "button", "aria-pressed": pressed === undefined ? null : String(pressed), "aria-label": `${describe || text} ${page.predicateName(p)}` }, text);
    button.addEventListener("click", (e) => { e.stopPropagation(); action(); });
    title.append(button);
  };
  tool("Rename", () => rename(p));
  tool(merged ? `Same as ${merged}` : "Merge", () => merge(p), Boolean(merged), "Merge");
  tool(standing === "banned" ? "Banned" : "Ban", () => stand(p, standing, standing === "banned" ? "free" : "banned"), standing === "banned", "Ban");
  tool(standing === "pinned" ? "Pinned" : "Pin", () => stand(p, standing, standing === "pinned" ? "free" : "pinned"), standing === "pinned", "Pin");
};
function stand(p, old, now) {
  send([{ kind: "standing", predicate: data.predicates[p].name, old, new: now }], `${page.predicateName(p)} is ${now}`);
}
function rename(p) {
  const old = page.predicateName(p);
  dialog(`Rename ${old}`, "New name, without spaces or brackets", old, null, (name) => {
    if (name && name !== old) send([{ kind: "rename", predicate: data.predicates[p].name, old, new: name }], `${old} is now ${name}`);
  });
}
function merge(p) {
  const entry = data.predicates[p], old = own(data.corrections.merged, entry.name) || null;
  if (old) { send([{ kind: "merge", predicate: entry.name, old, new: null }], `${entry.name} stands for itself`); return; }
  const others = data.predicates.filter((q) => q !== entry && !q.given && q.types.join() === entry.types.join()).map((q) => q.name);
  dialog(`${entry.name} means the same as`, "A predicate with the same arguments, by the model's name; it stands for both", "", others, (name) => {
    if (name) send([{ kind: "merge", predicate: entry.name, old, new: name }], `${entry.name} is merged with ${name}`);
  });
}
function dialog(title, hint, value, choices, done) {
  const back = document.activeElement, input = el("input", { type: "text", value, "aria-label": hint, autocomplete: "off", spellcheck: "false", list: choices ? "choices" : null });
  const list = choices ? el("datalist", { id: "choices" }, ...choices.map((c) => el("option", { value: c }))) : null;
  const cancel = el("button", { type: "button" }, "Cancel"), ok = el("button", { type: "button" }, "Save");
  const box = el("dialog", { "aria-label": title }, el("strong", {}, title), el("p", { class: "note" }, hint), input, list, el("menu", {}, cancel, ok));
  const finish = (save) => { box.close(); box.remove(); back?.isConnected && back.focus(); if (save) done(input.value.trim()); };
  cancel.addEventListener("click", () => finish(false));
  ok.addEventListener("click", () => finish(true));
  input.addEventListener("keydown", (e) => { if (e.key === "Enter") { e.preventDefault(); finish(true); } });
  box.addEventListener("cancel", (e) => { e.preventDefault(); finish(false); });
  document.body.append(box);
  box.showModal();
  input.select();
}

for (const button of document.querySelectorAll("button.accept")) {
  button.addEventListener("click", () => {
    const s = data.suspicions[+button.dataset.number], d = data.demos.findIndex((x) => x.name === s.demo);
    const row = data.demos[d].index.get(s.atom.join(" "));
    const rows = s.doubts.filter(([t, , likely]) => page.label(d, row, t) !== likely).map(([t, , likely]) => labelRow(d, row, t, likely));
    if (rows.length) send(rows, `${s.text}: ${rows.length} labels set`);
    button.textContent = "Accepted"; button.disabled = true;
  });
}
for (const button of document.querySelectorAll("button.pin")) {
  button.addEventListener("click", () => {
    const p = data.predicates.findIndex((q) => q.name === button.dataset.predicate);
    stand(p, own(data.corrections.standing, button.dataset.predicate) || "free", "pinned");
    button.disabled = true;
  });
}
$("learn").addEventListener("click", () => { $("learn").disabled = true; $("learning").className = "status"; $("learning").textContent = "starting"; sending = sending.then(() => ask("learn", {})).catch(fail); });

const kept = sessionStorage.getItem("pix2pred");
if (kept) {
  sessionStorage.removeItem("pix2pred");
  const { open, filter, search, y } = JSON.parse(kept);
  $("filter").value = filter; $("search").value = search;
  page.redraw();
  for (const x of document.querySelectorAll("details.demo")) x.open = open.includes(+x.dataset.demo);
  requestAnimationFrame(() => scrollTo({ top: y, behavior: "instant" }));
  say("learned again");
}
let failures = 0;
async function poll() {
  try { await ask("state"); if (failures) $("learning").textContent = ""; failures = 0; } catch (error) { if (++failures === 2) fail(error); }
  setTimeout(poll, document.hidden ? 5000 : $("learn").disabled ? 500 : 2000);
}
poll();
})();
