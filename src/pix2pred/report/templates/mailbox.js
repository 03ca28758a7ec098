"use strict";
/* Questions of a mailbox: pictures, a row of buttons for every atom, keys, progress. Text only enters as text. */
(() => {
  const WORDS = ["True", "False", "Unknown"], KEYS = { t: "True", f: "False", u: "Unknown", "?": "Unknown" };
  const EVERY = 1000; // milliseconds between two looks at what waits
  const at = (id) => document.getElementById(id);
  const make = (tag, properties = {}, ...children) => { const x = Object.assign(document.createElement(tag), properties); x.append(...children); return x; };
  let shown = null, standing = null, sending = false, row = 0;

  const fetched = async (path, options) => {
    const answer = await fetch(path, options);
    const isJson = (answer.headers.get("Content-Type") || "").startsWith("application/json");
    const body = isJson ? await answer.json() : await answer.text();
    if (!answer.ok) throw new Error(isJson ? body.error : body);
    return body;
  };

  const minutes = (seconds) => seconds < 90 ? "about a minute" : `about ${Math.round(seconds / 60)} minutes`;
  const count = (n, noun) => `${n} ${noun}${n === 1 ? "" : "s"}`;

  const tellProgress = () => {
    const { answered, ready, expected, seconds, waiting } = standing, done = answered + ready;
    const all = Math.max(expected || 0, done + waiting.length);
    let text = expected === null ? `${done} answered, ${waiting.length} waiting` : `${done} of ${all}`;
    if (seconds !== null && waiting.length) text += `; ${minutes(seconds)}`;
    at("progress").textContent = text;
    at("bar").setAttribute("aria-valuemax", all); at("bar").setAttribute("aria-valuenow", done);
    at("bar").firstElementChild.style.width = `${all ? (100 * done) / all : 0}%`;
  };

  const tellIdle = () => {
    at("question").hidden = true; at("idle").hidden = false;
    at("idle").textContent = standing.ready
      ? `${count(standing.ready, "answer")} ${standing.ready === 1 ? "lies" : "lie"} ready for the command that asks. If it has stopped, start it again: it goes on from here.`
      : "Nothing waits. New questions appear here by themselves while the command that asks is running.";
  };

  const listWaiting = () => {
    const which = at("which"), names = standing.waiting;
    if (document.activeElement === which) return;
    which.replaceChildren(...names.map((name) => make("option", { value: name, textContent: name, selected: shown && name === shown.name })));
    which.parentElement.hidden = names.length < 2;
  };

  const look = async () => {
    try {
      standing = await fetched("standing");
      tellProgress();
      const gone = shown && !standing.waiting.includes(shown.name);
      if (!shown || gone) await show(standing.waiting[0]);
      listWaiting();
    } catch (error) { at("progress").textContent = `The page's server cannot be reached: ${error.message}`; }
  };

  const show = async (name) => {
    if (!name) { shown = null; tellIdle(); return; }
    shown = await fetched(`question/${encodeURIComponent(name)}`);
    const q = shown, labels = q.atoms.length > 0;
    at("idle").hidden = true; at("question").hidden = false;
    at("about").textContent = q.about || q.name;
    at("skill").textContent = q.skill;
    at("problem").hidden = !q.problem; at("problem").textContent = q.problem.replace(/^# /, "");
    at("pictures").replaceChildren(...q.pictures.map((p) => picture(q, p)));
    at("tools").hidden = at("atoms").hidden = !labels; at("free").hidden = labels;
    at("rest").hidden = !q.atoms.some((a) => a.before || a.said);
    at("hint").textContent = !labels ? "Write what the question asks for; words around it are fine."
      : q.purpose === "double-check" ? "Your answer, once more: look again, and send it when it is right."
      : q.states.length > 1 ? "Give the value in every state; a choice goes on to the states after it." : "What do the pictures show?";
    at("atoms").replaceChildren(...q.atoms.map((a, n) => atom(q, a, n)));
    at("text").value = labels ? "" : q.returned;
    at("prompt").textContent = q.prompt; at("prompt").parentElement.open = !labels;
    row = 0; tellLeft(); here(firstOpen());
    at("about").focus({ preventScroll: true }); window.scrollTo(0, 0);
  };

  const picture = (q, p) => {
    const source = `picture/${encodeURIComponent(q.name)}/${p.file}`, text = p.heading || p.file;
    const button = make("button", { type: "button", ariaLabel: `enlarge: ${text}` }, make("img", { src: source, alt: text }));
    button.onclick = () => { at("zoomed").src = source; at("zoomed").alt = text; at("zoom-text").textContent = text; at("zoom").showModal(); };
    return make("figure", { className: q.states.at(-1) === p.state && q.states.length === 1 ? "now" : "" }, button, make("figcaption", { textContent: text }));
  };

  const atom = (q, a, n) => {
    const notes = [a.before && `before: ${a.before}`, a.said && `answered: ${a.said}`, a.meaning].filter(Boolean).join(" · ");
    const name = make("span", { className: "words", textContent: a.atom }); if (notes) name.append(make("small", { textContent: notes }));
    const choices = make("div", { className: "choices" }, ...q.states.map((state) => {
      const choice = make("span", { className: "choice" });
      if (q.states.length > 1) choice.append(make("span", { textContent: state }));
      for (const word of WORDS) {
        const input = make("input", { type: "radio", name: `${n}-${state}`, value: word, ariaLabel: q.states.length > 1 ? `state ${state}: ${word}` : word });
        input.onchange = () => { carry(q, n, state, word); here(n); tellLeft(); };
        if (q.states.length === 1 && a.said === word) input.checked = true;
        choice.append(make("label", { className: a.before === word ? "was" : "" }, input, make("b", { textContent: q.states.length > 1 ? word[0].replace("U", "?") : word })));
      }
      return choice;
    }));
    const made = make("fieldset", { className: "atom" }, make("legend", {}, name), choices);
    made.addEventListener("focusin", () => here(n));
    return made;
  };

  /* In a question about several states a value holds until the next choice made by hand. */
  const carry = (q, n, state, word) => {
    const group = (s) => [...document.getElementsByName(`${n}-${s}`)];
    group(state).forEach((x) => { x.dataset.chosen = "yes"; });
    for (const later of q.states.filter((s) => s > state)) {
      if (group(later).some((x) => x.dataset.chosen)) break;
      group(later).forEach((x) => { x.checked = x.value === word; });
    }
  };

  const value = (n, state) => { const x = [...document.getElementsByName(`${n}-${state}`)].find((i) => i.checked); return x ? x.value : null; };
  const complete = (n) => shown.states.every((state) => value(n, state));
  const open = () => shown.atoms.map((_, n) => n).filter((n) => !complete(n));
  const firstOpen = () => open()[0] ?? 0;
  const tellLeft = () => {
    const left = shown.atoms.length ? open().length : 0;
    at("left").textContent = left ? `${count(left, "atom")} without a value` : ""; at("send").disabled = sending || left > 0;
  };
  const here = (n) => {
    row = n; [...at("atoms").children].forEach((x, i) => x.classList.toggle("here", i === n));
    const box = at("atoms").children[n]?.getBoundingClientRect();
    if (box && box.bottom > innerHeight - 70) at("atoms").children[n].scrollIntoView({ block: "center" });
  };
  const set = (n, word) => {
    const state = shown.states.find((s) => !value(n, s)) ?? shown.states.at(-1);
    const input = [...document.getElementsByName(`${n}-${state}`)].find((x) => x.value === word);
    input.checked = true; input.onchange();
    const next = open().find((i) => i > n) ?? open()[0];
    here(next ?? n); if (next === undefined) at("send").focus();
  };
  const asBefore = (n) => { const a = shown.atoms[n], word = a.said || a.before; if (word) set(n, word); };

  const send = async () => {
    const values = Object.fromEntries(shown.atoms.map((a, n) => [a.atom, Object.fromEntries(shown.states.map((s) => [s, value(n, s)]))]));
    const body = JSON.stringify(shown.atoms.length ? { values } : { text: at("text").value });
    sending = true; at("send").disabled = true;
    try {
      standing = await fetched(`answer/${encodeURIComponent(shown.name)}`, { method: "POST", headers: { "Content-Type": "application/json" }, body });
      tellProgress(); await show(standing.waiting[0]); listWaiting();
    } catch (error) { at("problem").hidden = false; at("problem").textContent = error.message; }
    sending = false; if (shown) tellLeft();
  };

  at("form").onsubmit = (event) => { event.preventDefault(); if (!at("send").disabled) send(); };
  at("rest").onclick = () => { for (const n of open()) asBefore(n); tellLeft(); };
  at("which").onchange = () => show(at("which").value);
  at("zoom").onclick = () => at("zoom").close();
  document.addEventListener("keydown", (event) => {
    const typing = /^(TEXTAREA|SELECT)$/.test(event.target.tagName) || at("zoom").open;
    if (!shown || event.altKey || event.metaKey) return;
    if (event.key === "Enter" && (event.ctrlKey || (!typing && !/^(BUTTON|SUMMARY)$/.test(event.target.tagName)))) { event.preventDefault(); if (!at("send").disabled) send(); return; }
    if (typing || event.ctrlKey || !shown.atoms.length) return;
    const key = event.key.toLowerCase();
    if (KEYS[key]) { event.preventDefault(); set(row, KEYS[key]); }
    else if (key === "b") { event.preventDefault(); asBefore(row); }
    else if (key === "arrowdown" || key === "j") { event.preventDefault(); here(Math.min(row + 1, shown.atoms.length - 1)); }
    else if (key === "arrowup" || key === "k") { event.preventDefault(); here(Math.max(row - 1, 0)); }
  });
  look(); setInterval(look, EVERY);
})();
