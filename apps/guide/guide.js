"use strict";
// Asks for frames one after another; draws the picture, solid quads where tags are and hollow ones
// where they should be, each tag in its colour.
const $ = (id) => document.getElementById(id);
let guidance = null, asked = -1, mirror = false, files = "", ended = false;

const colour = (tag) => `hsl(${(tag * 137.508) % 360} 90% 58%)`;
const swaps = { left: "right", right: "left", "tilt left": "tilt right", "tilt right": "tilt left",
  "turn clockwise": "turn anticlockwise", "turn anticlockwise": "turn clockwise" };
const details = { "tilt left": "right edge towards the camera", "tilt right": "left edge towards the camera",
  "tilt up": "lower edge towards the camera", "tilt down": "upper edge towards the camera" };
// "tilt left", mirrored: the edge that comes nearer is the picture's left one.
const say = (move) => {
  const words = mirror && swaps[move] || move;
  return details[words] ? `${words} <small>${details[words]}</small>` : words;
};

function path(context, quad) {
  context.beginPath();
  for (let i = 1; i < quad.length; i += 2) context.lineTo(quad[i] + .5, quad[i + 1] + .5);
  context.closePath();
}

function drawLive(live, picture) {
  const canvas = $("live"), context = canvas.getContext("2d");
  const width = guidance.width, height = guidance.height;
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  context.save();
  if (mirror) { context.translate(width, 0); context.scale(-1, 1); }
  context.fillStyle = "#000";
  context.fillRect(0, 0, width, height);
  if (picture) context.drawImage(picture, 0, 0, width, height);
  if (!live.done) {
    const thin = Math.max(1, width / 500);
    for (const quad of live.quads) {
      path(context, quad);
      context.globalAlpha = .75; context.fillStyle = colour(quad[0]); context.fill();
    }
    context.globalAlpha = 1;
    const current = live.guidance === guidance.number && !live.busy;
    for (const quad of current ? guidance.suggested : []) {
      path(context, quad);
      context.strokeStyle = "#000"; context.lineWidth = 3 * thin; context.stroke();
      context.strokeStyle = colour(quad[0]); context.lineWidth = 1.6 * thin; context.stroke();
    }
    if (live.progress > 0) {
      context.strokeStyle = "#3fbf7f"; context.lineWidth = 8 * thin;
      context.strokeRect(0, 0, width, height);
    }
  }
  context.restore();
}

function drawAdvice(live) {
  let words = "", level = "";
  if (live.done) {
    const accurate = guidance.met;
    words = (accurate ? "Done" : "Stopped before the accuracy was reached") +
      (live.rectified ? " <small>straight lines should look straight</small>" : "");
  } else if (live.busy) words = "Thinking &hellip; <small>frame kept</small>";
  else if (live.quads.length === 0) words = "Show the target to the camera";
  else if (live.matched && live.steady) words = "Hold still &hellip;";
  else if (live.matched) words = "Hold it still";
  else if (live.moves.length === 0) words = "Match the hollow quads";
  else words = say(live.moves[0]) + (live.moves[1] ? ` <small>then ${say(live.moves[1]).replace(/<.*/, "")}</small>` : "");
  if ($("advice").innerHTML !== words) $("advice").innerHTML = words;

  const cells = live.cells, show = cells !== null && !live.done && !live.busy;
  const place = (c) => 100 / (1 + c / 6);
  $("near").style.width = show ? `${place(cells)}%` : "0";
  $("limit").hidden = !show;
  $("limit").style.left = `${place(live.limit)}%`;
  if (show) level = live.matched ? "perfect" : cells < 3 * Math.max(1, live.limit) ? "good" : "far";
  $("near").style.background = `var(--${level === "perfect" ? "good" : level === "good" ? "near" : "far"})`;
  $("nearness").textContent = show ? `${level === "perfect" ? "Perfect" : level === "good" ? "Good" : "Not yet"}: ${cells.toFixed(1)} cells off` : "";
}

function drawSpark() {
  const canvas = $("spark"), context = canvas.getContext("2d"), steps = guidance.steps;
  const w = canvas.width, h = canvas.height, left = 34, bottom = 16;
  context.clearRect(0, 0, w, h);
  const values = steps.map((s) => s.px).filter((v) => v > 0);
  const high = Math.log10(Math.max(10, guidance.accuracy * 10, ...values)), low = Math.log10(Math.min(guidance.accuracy / 3, ...values));
  const y = (px) => 6 + (h - bottom - 12) * (high - Math.log10(px)) / (high - low);
  const x = (i) => left + 8 + (w - left - 16) * i / Math.max(5, steps.length - 1);
  context.font = "11px sans-serif"; context.textAlign = "right"; context.fillStyle = "#9aa3ab"; context.strokeStyle = "#48525a";
  for (let p = Math.ceil(low); p <= high; ++p) {
    const at = y(10 ** p);
    context.fillText(String(10 ** p), left - 4, at + 4);
    context.beginPath(); context.moveTo(left, at); context.lineTo(w, at); context.stroke();
  }
  context.setLineDash([4, 3]); context.strokeStyle = "#3fbf7f";
  context.beginPath(); context.moveTo(left, y(guidance.accuracy)); context.lineTo(w, y(guidance.accuracy)); context.stroke();
  context.setLineDash([]);
  context.strokeStyle = "#e8eaec"; context.lineWidth = 1.5; context.beginPath();
  steps.forEach((s, i) => { if (s.px > 0) context.lineTo(x(i), y(s.px)); });
  context.stroke(); context.lineWidth = 1;
  context.textAlign = "center";
  steps.forEach((s, i) => {
    context.fillStyle = "#9aa3ab"; context.fillText(String(i + 1), x(i), h - 3);
    if (!(s.px > 0)) return;
    context.beginPath(); context.arc(x(i), y(s.px), 3.5, 0, 7);
    context.fillStyle = s.bootstrapping ? "#14171a" : "#e8eaec"; context.fill(); context.stroke();
  });
}

const ramp = [[43, 63, 140], [42, 140, 140], [127, 191, 79], [229, 181, 58], [217, 68, 63]];
function shade(t) {
  const at = Math.max(0, Math.min(.9999, t)) * (ramp.length - 1), i = Math.floor(at), f = at - i;
  return `rgb(${ramp[i].map((c, k) => Math.round(c + f * (ramp[i + 1][k] - c))).join()})`;
}

function drawMap() {
  const canvas = $("map"), context = canvas.getContext("2d"), map = guidance.map;
  canvas.height = Math.round(canvas.width * guidance.height / guidance.width);
  context.fillStyle = "#0d0f11"; context.fillRect(0, 0, canvas.width, canvas.height);
  const low = guidance.accuracy / 10, high = guidance.accuracy * 10;
  $("low").textContent = `${+low.toPrecision(2)}`; $("high").textContent = `${+high.toPrecision(2)} px`;
  const w = canvas.width / map.columns, h = canvas.height / map.rows;
  for (let i = 0; i < map.px.length; ++i) {
    if (map.px[i] === null) continue;
    const column = mirror ? map.columns - 1 - i % map.columns : i % map.columns;
    const x = column * w, y = Math.floor(i / map.columns) * h;
    context.fillStyle = shade(Math.log(map.px[i] / low) / Math.log(high / low));
    context.fillRect(x, y, w + 1, h + 1);
    if (map.reached[i]) continue;
    context.strokeStyle = "rgba(0,0,0,.55)";
    context.beginPath(); context.moveTo(x, y + h); context.lineTo(x + w, y); context.stroke();
  }
}

function drawSession() {
  const last = guidance.steps[guidance.steps.length - 1];
  $("ere").textContent = last && last.px > 0 ? (last.px >= 1000 ? "> 1000" : last.px.toPrecision(3)) : "\u2013";
  $("goal").textContent = `goal ${guidance.accuracy} px` + (guidance.bootstrapping && last ? "; too few frames yet to rely on it" : "");
  $("ere").style.color = guidance.met ? "var(--good)" : "";
  $("model").textContent = guidance.solved ? guidance.model : "";
  const digits = (p) => Math.max(0, Math.min(6, 1 - Math.floor(Math.log10(p.deviation || 1))));
  $("parameters").replaceChildren(...guidance.parameters.map((p) => {
    const row = document.createElement("tr");
    if (p.loose) row.className = "loose";
    for (const text of [p.name, p.value.toFixed(digits(p)), `\u00b1 ${p.deviation.toPrecision(2)} ${p.unit === "1" ? "" : p.unit}`, p.loose ? "open" : ""]) {
      const cell = document.createElement("td");
      cell.textContent = text;
      row.append(cell);
    }
    return row;
  }));
  $("message").textContent = guidance.message;
  drawSpark();
  drawMap();
}

function drawFacts(live) {
  const n = guidance.frames;
  let text = `${n} frame${n === 1 ? "" : "s"}; ${live.fps.toFixed(0)} pictures a second`;
  if (guidance.solved) text += `; residuals ${guidance.rms.toFixed(3)} px`;
  if (!live.done && guidance.expected) text += `; about ${guidance.expected.toPrecision(2)} px after the next frame`;
  if (live.done && files) text += `. Written: ${files}`;
  if ($("facts").textContent !== text) $("facts").textContent = text;
  for (const [id, shown] of [["capture", !live.done], ["finish", !live.done], ["resume", live.done], ["close", live.done]]) $(id).hidden = !shown;
  $("remove").disabled = n === 0 || live.busy;
}

async function picture(frame) {
  const answer = await fetch(`live.jpg?frame=${frame}`);
  return answer.ok ? createImageBitmap(await answer.blob()) : null;
}

async function loop() {
  let frame = 0, misses = 0;
  const options = await (await fetch("options.json")).json();
  files = options.files;
  setMirror(options.mirror);
  while (!ended) {
    try {
      const live = await (await fetch(`live.json?after=${frame}`)).json();
      const [image] = await Promise.all([picture(live.frame), live.guidance !== asked || !guidance ? session() : null]);
      frame = live.frame;
      drawLive(live, image);
      drawAdvice(live);
      drawFacts(live);
      if (image) image.close();
      misses = 0;
    } catch (error) {
      if (++misses > 8) return end("The program has ended.");
      await new Promise((done) => setTimeout(done, 250));
    }
  }
}

async function session() {
  const next = await (await fetch("session.json")).json();
  const changed = !guidance || next.number !== guidance.number;
  guidance = next;
  asked = next.number;
  if (changed) drawSession();
}

function end(words) {
  ended = true;
  $("advice").textContent = words;
  for (const button of document.querySelectorAll("button")) button.disabled = true;
}

function setMirror(on) {
  mirror = on;
  $("mirror").setAttribute("aria-pressed", String(on));
  if (guidance) drawMap();
}

const press = (name) => fetch(name, { method: "POST", headers: { "X-Graticule": "1" } });
for (const id of ["capture", "remove", "finish", "resume"]) $(id).onclick = () => press(id);
$("close").onclick = async () => { await press("close"); end("The program has ended. You can close this page."); };
$("mirror").onclick = () => setMirror(!mirror);
addEventListener("keydown", (event) => {
  if (event.code === "Space" && event.target === document.body) { event.preventDefault(); press("capture"); }
});
loop();
