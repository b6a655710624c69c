"use strict";
// The worst part of each method: a tip that pushes, the part in its guide, force and position.
(() => {
  const scenes = JSON.parse(document.getElementById("courses").textContent);
  const byId = (id) => document.getElementById(id);
  const stage = byId("stage"), seek = byId("seek"), told = byId("told"), play = byId("play");
  const choice = byId("scene"), slowed = byId("slowed");
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)");
  const INK = "#1b1f24", SOFT = "#57606a", LINE = "#d8dee4", FORCE = "#0072B2", WAY = "#D55E00";
  const SLIP = "#F3D9C9", STEEL = "#aab4be", TIP = "#3d4650";
  const SLIP_PLAYS_S = 8, CALM_STEP_S = 0.5;
  const state = { scene: 0, mode: "slip", time: 0, playing: false, loop: 0, last: 0, drawn: 0 };

  const current = () => scenes[state.scene];
  const columns = () => current()[state.mode];
  const start = () => columns().t[0];
  const end = () => columns().t[columns().t.length - 1];
  const speed = () => (state.mode === "whole" ? 1 : Math.min(1, (end() - start()) / SLIP_PLAYS_S));

  // The rows are chosen, not evenly spaced: forces are held between them, positions lie on a line.
  function at(columns, time) {
    const { t, x, f, b } = columns;
    let low = 0, high = t.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (t[middle] <= time) low = middle; else high = middle;
    }
    const span = t[high] - t[low], share = span > 0 ? Math.min(1, Math.max(0, (time - t[low]) / span)) : 0;
    const between = (v) => v[low] + share * (v[high] - v[low]);
    return { x: between(x), f: share < 1 ? f[low] : f[high], b: between(b) };
  }

  function extent(values) {
    let low = Infinity, high = -Infinity;
    for (const v of values) { if (v < low) low = v; if (v > high) high = v; }
    return [low, high];
  }

  function ticks(low, high, count) {
    const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw);
    const found = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
    return found;
  }

  const brief = (v) => String(+v.toPrecision(4));

  function draw() {
    const ratio = window.devicePixelRatio || 1, box = stage.getBoundingClientRect();
    const width = Math.max(280, box.width), height = Math.max(240, box.height);
    if (stage.width !== Math.round(width * ratio) || stage.height !== Math.round(height * ratio)) {
      stage.width = Math.round(width * ratio);
      stage.height = Math.round(height * ratio);
    }
    const pen = stage.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "12px system-ui, sans-serif";
    const now = at(columns(), state.time);
    const left = 62, inner = width - left - 14;
    drawGuide(pen, left, 8, inner, height * 0.2, now);
    drawMagnifier(pen, left, height * 0.2 + 26, inner, height * 0.11, now);
    const top = height * 0.31 + 62, tall = (height - top - 34) / 2 - 12;
    const c = columns();
    drawTrace(pen, { left, top, inner, tall, name: "force (N)", lines: [[c.b, SOFT, [5, 4]], [c.f, FORCE, []]], zero: true });
    drawTrace(pen, { left, top: top + tall + 20, inner, tall, name: "position (mm)", lines: [[c.x, WAY, []]], times: true });
    tell(now);
    state.drawn += 1;
    stage.dataset.frames = state.drawn;
    stage.dataset.time = state.time;
  }

  function drawGuide(pen, left, top, inner, tall, now) {
    const s = current(), long = s.length_mm;
    const px = (mm) => left + ((mm + 0.32 * long) / (2.4 * long)) * inner;
    const wall = tall * 0.2, part = tall - 2 * wall - 4;
    pen.fillStyle = STEEL;
    pen.fillRect(px(0), top, px(long) - px(0), wall);
    pen.fillRect(px(0), top + tall - wall, px(long) - px(0), wall);
    pen.fillStyle = "#e8c9a0";
    pen.strokeStyle = INK;
    pen.lineWidth = 1;
    const x0 = px(now.x), x1 = px(now.x + long);
    pen.fillRect(x0, top + wall + 2, x1 - x0, part);
    pen.strokeRect(x0, top + wall + 2, x1 - x0, part);
    const pushes = now.f > 0, tip = x0 - (pushes ? 0 : 7), middle = top + tall / 2;
    pen.globalAlpha = pushes ? 1 : 0.45;
    pen.fillStyle = TIP;
    pen.beginPath();
    pen.moveTo(left, middle - 7); pen.lineTo(tip - 10, middle - 7); pen.lineTo(tip, middle - 3);
    pen.lineTo(tip, middle + 3); pen.lineTo(tip - 10, middle + 7); pen.lineTo(left, middle + 7);
    pen.fill();
    pen.globalAlpha = 1;
    drawArrow(pen, x0 + 8, middle, (now.f / s.stiction_n) * 0.22 * inner, px(2.06 * long));
    pen.fillStyle = SOFT;
    pen.textAlign = "left";
    pen.fillText("tip", left, middle - 12);
    pen.fillText(`guide, ${brief(long)} mm`, px(0), top + tall + 14);
  }

  function drawArrow(pen, x, y, long, limit) {
    if (long < 2) return;
    const tip = Math.min(x + long, limit);
    pen.strokeStyle = pen.fillStyle = FORCE;
    pen.lineWidth = 3;
    pen.beginPath(); pen.moveTo(x, y); pen.lineTo(Math.max(x, tip - 7), y); pen.stroke();
    pen.beginPath(); pen.moveTo(tip, y); pen.lineTo(tip - 9, y - 5); pen.lineTo(tip - 9, y + 5); pen.fill();
  }

  function drawMagnifier(pen, left, top, inner, tall, now) {
    const s = current(), [low, high] = extent(s.slip.x), room = 0.08 * (high - low) || 1e-3;
    const from = low - room, to = high + room;
    const px = (mm) => left + ((mm - from) / (to - from)) * inner;
    const slipFrom = at(s.slip, s.slip_s[0]).x, slipTo = at(s.slip, s.slip_s[1]).x;
    pen.fillStyle = SLIP;
    pen.fillRect(px(slipFrom), top, Math.max(1, px(slipTo) - px(slipFrom)), tall);
    pen.strokeStyle = LINE;
    pen.lineWidth = 1;
    pen.strokeRect(left, top, inner, tall);
    pen.fillStyle = SOFT;
    pen.textAlign = "center";
    for (const mark of ticks(from, to, Math.max(2, Math.floor(inner / 130)))) {
      pen.beginPath(); pen.moveTo(px(mark), top + tall); pen.lineTo(px(mark), top + tall - 6); pen.strokeStyle = SOFT; pen.stroke();
      pen.fillText(`${+mark.toFixed(5)} mm`, px(mark), top + tall + 13);
    }
    const inside = now.x >= from && now.x <= to;
    if (inside) {
      pen.fillStyle = "#e8c9a0";
      pen.fillRect(px(now.x), top + 4, left + inner - px(now.x), tall - 12);
      pen.fillStyle = INK;
      pen.fillRect(px(now.x) - 1, top + 1, 2, tall - 2);
    }
    pen.textAlign = "right";
    pen.fillStyle = SOFT;
    const across = to - from >= 1 ? `${brief(to - from)} mm` : `${brief(1e3 * (to - from))} µm`;
    const where = inside ? "" : now.x < from ? ", the part's edge is not there yet" : ", the part's edge is past it";
    pen.fillText(`magnifier, ${across} across${where}`, left + inner, top - 6);
  }

  function drawTrace(pen, panel) {
    const { left, top, inner, tall, lines } = panel, c = columns();
    const px = (t) => left + ((t - start()) / (end() - start() || 1)) * inner;
    const ends = lines.map(([values]) => extent(values));
    let low = Math.min(...ends.map((e) => e[0])), high = Math.max(...ends.map((e) => e[1]));
    if (panel.zero) low = Math.min(0, low);
    const room = 0.06 * (high - low) || 1e-6;
    high += room; low -= panel.zero ? 0 : room;
    const py = (v) => top + tall - ((v - low) / (high - low)) * tall;
    const [slipFrom, slipTo] = current().slip_s;
    pen.fillStyle = SLIP;
    pen.fillRect(px(slipFrom), top, Math.max(1, px(slipTo) - px(slipFrom)), tall);
    pen.textAlign = "right";
    for (const mark of ticks(low, high, 3)) {
      pen.strokeStyle = LINE; pen.lineWidth = 1;
      pen.beginPath(); pen.moveTo(left, py(mark)); pen.lineTo(left + inner, py(mark)); pen.stroke();
      pen.fillStyle = SOFT;
      pen.fillText(+mark.toPrecision(6), left - 6, py(mark) + 4);
    }
    pen.save();
    pen.beginPath(); pen.rect(left, top - 2, inner, tall + 4); pen.clip();
    for (const [values, color, dash] of lines) {
      pen.strokeStyle = color; pen.lineWidth = dash.length ? 1 : 1.4; pen.setLineDash(dash);
      pen.beginPath();
      values.forEach((v, i) => (i ? pen.lineTo(px(c.t[i]), py(v)) : pen.moveTo(px(c.t[i]), py(v))));
      pen.stroke();
    }
    pen.restore();
    pen.setLineDash([]);
    pen.strokeStyle = INK; pen.lineWidth = 1;
    pen.beginPath(); pen.moveTo(px(state.time), top); pen.lineTo(px(state.time), top + tall); pen.stroke();
    pen.textAlign = "left"; pen.fillStyle = "rgba(255, 255, 255, 0.85)";
    pen.fillRect(left + 3, top + 1, pen.measureText(panel.name).width + 8, 17);
    pen.fillStyle = INK;
    pen.fillText(panel.name, left + 7, top + 14);
    if (!panel.times) return;
    const slip = state.mode === "slip", zero = slip ? slipFrom : 0, unit = slip ? 1e3 : 1;
    pen.textAlign = "center"; pen.fillStyle = SOFT;
    for (const mark of ticks((start() - zero) * unit, (end() - zero) * unit, Math.max(2, Math.floor(inner / 110)))) {
      pen.fillText(+mark.toPrecision(6), px(zero + mark / unit), top + tall + 15);
    }
    pen.fillText(slip ? "time since it slips (ms)" : "time (s)", left + inner / 2, top + tall + 30);
  }

  function tell(now) {
    const s = current(), slip = state.mode === "slip";
    const time = slip ? `${((state.time - s.slip_s[0]) * 1e3).toFixed(2)} ms since it slips` : `${state.time.toFixed(2)} s`;
    told.textContent = `Part no. ${s.part}, ${brief(s.mass_kg)} kg, breaks loose at ${brief(s.stiction_n)} N; jumps ` +
      `${brief(s.jump_mm)} mm at most${s.released ? "" : "; left in place"}. ${time}: force ${now.f.toFixed(0)} N, position ${now.x.toFixed(slip ? 4 : 2)} mm.`;
  }

  function show(time) {
    state.time = Math.min(end(), Math.max(start(), time));
    seek.value = Math.round((1000 * (state.time - start())) / (end() - start() || 1));
    seek.setAttribute("aria-valuetext", `${state.time.toFixed(4)} seconds`);
    draw();
  }

  function setPlaying(yes) {
    state.playing = yes;
    play.textContent = yes ? "Pause" : "Play";
    play.setAttribute("aria-pressed", String(yes));
    if (!yes) return;
    if (state.time >= end()) state.time = start();
    state.last = performance.now();
    state.loop += 1;
    next(state.loop);
  }

  // Smoothly, or in rare steps for those who asked their system for less motion.
  function next(loop) {
    if (calm.matches) setTimeout(step, 1000 * CALM_STEP_S, loop); else requestAnimationFrame(() => step(loop));
  }

  function step(loop) {
    if (!state.playing || loop !== state.loop) return;
    const now = performance.now(), passed = (now - state.last) / 1000;
    state.last = now;
    show(state.time + passed * speed());
    if (state.time >= end()) setPlaying(false); else next(loop);
  }

  function reset() {
    const factor = current().slip.t, long = factor[factor.length - 1] - factor[0];
    const times = Math.max(1, SLIP_PLAYS_S / (long || 1));
    slowed.textContent = times > 1 ? `slowed ${brief(+times.toPrecision(2))} times` : "in real time";
    show(start());
  }

  scenes.forEach((s, i) => choice.add(new Option(s.method, i)));
  choice.addEventListener("change", () => { state.scene = Number(choice.value); reset(); });
  document.querySelectorAll('input[name="mode"]').forEach((radio) =>
    radio.addEventListener("change", () => { state.mode = radio.value; reset(); }));
  play.addEventListener("click", () => setPlaying(!state.playing));
  seek.addEventListener("input", () => show(start() + (Number(seek.value) / 1000) * (end() - start())));
  stage.addEventListener("keydown", (event) => {
    const moves = { ArrowLeft: -0.01, ArrowRight: 0.01, Home: -2, End: 2 };
    if (event.key === " ") setPlaying(!state.playing);
    else if (event.key in moves) show(state.time + moves[event.key] * (end() - start()));
    else return;
    event.preventDefault();
  });
  const settle = () => { byId("calm").hidden = !calm.matches; };
  calm.addEventListener("change", settle);
  window.addEventListener("resize", draw);
  settle();
  reset();
})();
