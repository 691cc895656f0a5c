
// The replay of a run. `data` is what src/roah_rsbb/results/replay.py makes; its times are milliseconds since connect.
// Texts of robots are only ever set as text, never as markup.

const data = JSON.parse(document.getElementById("data").textContent);
const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16, 32, 64];
const STEP_MS = 5000;  // of the arrow keys
const ROW_EM = 2;  // height of a row of the list, as in the style sheet
const MAX_VIDEO_SPEED = 16;  // a browser plays no faster
const APART_S = 0.4;  // video and replay may differ by this much
const SAID_MS = 1500;  // a screen reader hears of changes at most this often
const SILENT_S = 3;  // after this silence, the referee was warned

const $ = (id) => document.getElementById(id);
const at = { time: 0, playing: false, speed: 1, chosen: -1, robot: 0 };
let shown = data.events.map((_, index) => index);  // indices of the events in the list
let offset = null;  // ms from connect to the beginning of the video; null: not set
let objectUrl = null;

// -- looking up -------------------------------------------------------------------------------------

// The index of the last item whose time, `time(item)`, is not after `moment`; -1: none.
function lastUpTo(items, moment, time) {
  let low = 0, high = items.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (time(items[middle]) <= moment) low = middle + 1; else high = middle;
  }
  return low - 1;
}

const first = (pair) => pair[0];

// The value of a track at a moment; undefined: not known yet.
function valueAt(track, moment) {
  const index = lastUpTo(track, moment, first);
  return index < 0 ? undefined : track[index][1];
}

// The times of the run at a moment, in seconds, as the box's clock counted them.
function clockAt(moment) {
  const index = lastUpTo(data.clock, moment, first);
  if (index < 0) return null;
  const [since, clock] = data.clock[index];
  const passed = Math.max(0, moment - since) / 1000;
  const spent = (name, counts) => (clock[name] || 0) + (clock[counts] ? passed : 0);
  return {
    ...clock, elapsed: spent("elapsed", "counting"), goal_elapsed: spent("goal_elapsed", "goal_counting"),
    setup_elapsed: spent("setup_elapsed", "setup_counting"), phase_elapsed: spent("phase_elapsed", "counting"),
  };
}

// The first moment at which the box's clock had counted these seconds.
function momentOf(seconds) {
  const index = data.clock.findIndex(([, clock], place) => {
    const [until] = data.clock[place + 1] || [Infinity];
    return clock.counting ? clockAt(until - 1).elapsed >= seconds : (clock.elapsed || 0) >= seconds;
  });
  return index < 0 ? data.length : data.clock[index][0] + Math.max(0, seconds - (data.clock[index][1].elapsed || 0)) * 1000;
}

// -- words ------------------------------------------------------------------------------------------

function duration(seconds) {
  const tenths = Math.max(0, Math.round(seconds * 10)), minutes = Math.floor(tenths / 600);
  const rest = `${String(Math.floor(tenths / 10) % 60).padStart(2, "0")}.${tenths % 10}`;
  return minutes < 60 ? `${minutes}:${rest}`
    : `${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, "0")}:${rest}`;
}

const offsetText = data.offset === 0 ? "UTC" : (() => {
  const minutes = Math.abs(data.offset) / 60, two = (number) => String(number).padStart(2, "0");
  return `${data.offset < 0 ? "−" : "+"}${two(Math.floor(minutes / 60))}:${two(minutes % 60)}`;
})();

function timeOfDay(moment) {
  return new Date(data.begin + moment + data.offset * 1000).toISOString().slice(11, 21);
}

const ofLimit = (seconds, limit) => limit ? `${duration(seconds)} of ${duration(limit)}` : duration(seconds);

// Pairs of label and text for the state at a moment.
function stateLines(moment) {
  const lines = [], add = (label, text, bad = false) => lines.push([label, text, bad]);
  const phase = valueAt(data.phase, moment), clock = clockAt(moment);
  if (phase) add("Phase", phase[1] ? `${phase[0]}: ${phase[1]}` : phase[0]);
  if (clock) {
    if (clock.setup_counting) add("Setup time", ofLimit(clock.setup_elapsed, clock.setup_limit));
    add("Time used", ofLimit(clock.elapsed, clock.limit) + (clock.paused ? `, paused: ${clock.paused}` : ""));
    if (clock.phase_number) {
      add(`Phase ${clock.phase_number} of ${clock.phases}`,
        `${clock.phase_name}: ${ofLimit(clock.phase_elapsed, clock.phase_limit)}`);
    }
    if (clock.goal) add(`Goal ${clock.goal}`, ofLimit(clock.goal_elapsed, clock.goal_limit));
  }
  const desc = valueAt(data.desc, moment);
  if (desc) add("Box says", desc);
  const robot = data.robots[at.robot];
  if (robot) {
    add("Box's state", valueAt(robot.box, moment) || "–");
    add("Robot's state", valueAt(robot.robot, moment) || "not heard yet");
    const link = robot.link[lastUpTo(robot.link, moment, first)];
    if (link && moment - link[0] < 3000) {
      const silent = link[1] > SILENT_S;
      add("Link", `longest silence ${link[1].toFixed(1)} s${silent ? " (too long)" : ""}, `
        + `lost ${link[2]} to the box, ${link[3]} to the robot`, silent);
      if (link[5] !== null) add("Clock skew", `${link[5] < 0 ? "−" : "+"}${Math.abs(link[5]).toFixed(3)} s`);
    } else add("Link", "no record");
  }
  for (const [label, name, indices] of data.latest) {
    if (name && robot && name !== robot.event_name) continue;
    const place = lastUpTo(indices, moment, (index) => data.events[index][0]);
    if (place >= 0) {
      const event = data.events[indices[place]];
      add(label, `${event[4]} (${timeOfDay(event[0])})`, Boolean(event[5]));
    }
  }
  return lines;
}

// -- the state --------------------------------------------------------------------------------------

function make(name, text, className) {
  const element = document.createElement(name);
  if (text !== undefined) element.textContent = text;
  if (className) element.className = className;
  return element;
}

const shownHere = new Map();  // what each part shows, as JSON: nothing is drawn twice

function changed(part, value) {
  const text = JSON.stringify(value);
  if (shownHere.get(part) === text) return false;
  shownHere.set(part, text);
  return true;
}

function drawState() {
  const lines = stateLines(at.time);
  if (changed("state", lines)) {
    $("state").replaceChildren(...lines.flatMap(([label, text, bad]) => [
      make("dt", label), make("dd", bad ? `⚠ ${text}` : text, bad ? "bad" : ""),
    ]));
  }
  drawScores();
  drawModule();
}

function drawScores() {
  const values = data.values.map((track) => valueAt(track, at.time)), total = valueAt(data.points, at.time);
  if (!changed("scores", [values, total, ofItem])) return;
  const rows = [], marked = new Set(data.timeline.map((one) => one.item));  // a button leads to an item's marks
  let group = null;
  data.items.forEach(([title, desc], index) => {
    if (!values[index]) return;
    if (title !== group) {
      const row = make("tr", undefined, "group"), heading = make("th", title);
      heading.colSpan = 3;
      heading.scope = "colgroup";
      row.append(heading);
      rows.push(row);
      group = title;
    }
    const row = make("tr");
    if (["0", "no", "–"].includes(values[index][0])) row.className = "none";
    const name = make("td", marked.has(index) ? undefined : desc), button = make("button", desc);
    button.type = "button";
    button.setAttribute("aria-pressed", String(index === ofItem));
    button.addEventListener("click", () => showItem(index));
    if (marked.has(index)) name.append(button);
    row.append(make("td", values[index][0]), make("td", values[index][1]), name);
    rows.push(row);
  });
  if (total !== undefined) {
    const row = make("tr", undefined, "total");
    row.append(make("td", ""), make("td", total), make("td", "Points in total"));
    rows.push(row);
  }
  $("scores").tBodies[0].replaceChildren(...rows);
  $("scores").hidden = $("scores-title").hidden = rows.length === 0;
}

function drawModule() {
  const lines = valueAt(data.module, at.time) || [];
  if (!changed("module", lines)) return;
  $("module").tBodies[0].replaceChildren(...lines.map(([group, name, value]) => {
    const row = make("tr");
    row.append(make("td", value), make("td", `${group}: ${name}`));
    return row;
  }));
  $("module").hidden = $("module-title").hidden = lines.length === 0;
}

let saidAt = 0;

// Let a screen reader say what changed, unless it did so just now.
function say() {
  const phase = valueAt(data.phase, at.time), robot = data.robots[at.robot];
  const words = [phase ? phase[0] : "", robot ? valueAt(robot.box, at.time) : ""].filter(Boolean).join(", ");
  const now = performance.now();
  if (at.playing && now - saidAt < SAID_MS || !changed("said", words)) return;
  saidAt = now;
  $("said").textContent = words;
}

// -- the picture ------------------------------------------------------------------------------------

// The looks of phases and states, as on the pages; of all others: waiting.
const LOOKS = {
  connected: "ready", running: "executing", ended: "completed", STOP: "stopped", PREPARE: "ready", PREPARING: "ready",
  WAITING_RESULT: "executing", EXECUTING: "executing", RESULT_TX: "completed",
};
// The signs of what happened in the run, beside its words; a mark has that of what it gave.
const SIGNS = {
  note: "✎", stop: "■", end: "■", start: "▶", restart: "▶", continue: "▶", resume: "▶", pause: "‖", phase: "»",
  sign_off: "✓", captain: "✓", outage: "⚠", proposal: "?",
};
const gives = ({ points, change }) => (points || change).startsWith("−") ? "penalty" : points || change ? "achievement" : "";
const signOf = (one) => SIGNS[one.kind] || { penalty: "▼", achievement: "▲" }[gives(one)] || "•";
// The lanes' names, where the kinds' are too long.
const SHORT = {
  "Timeline of states": "States", "Goals and results": "Goals", "Manual operations": "Operations",
  "Referee's commands": "Commands", "Home devices and tablet": "Devices",
};
const LANE = 20, GAP = 3, LEFT = 76;
let scale = () => LEFT;

function drawPicture() {
  const canvas = $("picture"), width = $("lanes").clientWidth, robot = data.robots[at.robot];
  const states = (track) => (context, top) => drawStates(context, top, track);
  const lanes = [];
  if (data.timeline.length) lanes.push(["Timeline", happened]);
  if (data.phase.length) lanes.push(["Phase", states(data.phase.map(([time, value]) => [time, value[0]]))]);
  if (robot) {
    lanes.push(["Box", states(robot.box)], ["Robot", states(robot.robot)]);
    if (robot.link.length) {
      lanes.push(["Silence", bars(robot.link, (link) => Math.min(1, link[1] / 5), (link) => link[1] > SILENT_S)]);
      lanes.push(["Lost", bars(robot.link, (link) => Math.min(1, (link[2] + link[3]) / 5), () => false)]);
    }
  }
  data.kinds.forEach((kind, number) => lanes.push([SHORT[kind] || kind, ticks(number)]));
  const height = lanes.length * (LANE + GAP), ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  canvas.style.height = `${height}px`;
  scale = (time) => LEFT + Math.min(1, Math.max(0, time / data.length)) * (width - LEFT - 2);
  const style = getComputedStyle(document.documentElement), context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  context.font = '11px "IBM Plex Sans", system-ui, sans-serif';
  context.textBaseline = "middle";
  const token = (name) => style.getPropertyValue(`--${name}`);
  context.palette = { text: token("text"), bad: token("warning"), line: token("line-control"), accent: token("action"),
    penalty: token("penalty"), achievement: token("achievement"),
    look: (name) => token(`state-${LOOKS[name] || "waiting"}-band`) };
  lanes.forEach(([title, draw], number) => {
    const top = number * (LANE + GAP);
    context.fillStyle = context.palette.text;
    context.fillText(title, 2, top + LANE / 2, LEFT - 6);
    context.strokeStyle = context.palette.line;
    context.strokeRect(LEFT, top + 0.5, width - LEFT - 2, LANE - 1);
    draw(context, top);
  });
}

function drawStates(context, top, track) {
  track.forEach(([time, name], index) => {
    const left = scale(time), right = index + 1 < track.length ? scale(track[index + 1][0]) : scale(data.length);
    const width = Math.max(1, right - left);
    context.fillStyle = context.palette.look(name);
    context.fillRect(left, top, width, LANE);
    context.fillStyle = "#ffffff";
    if (context.measureText(name).width + 6 < width) context.fillText(name, left + 3, top + LANE / 2);
  });
}

function happened(context, top) {
  context.textAlign = "center";
  for (const one of data.timeline) {
    context.fillStyle = context.palette[gives(one)] || context.palette.text;
    context.fillText(signOf(one), scale(one.at), top + LANE / 2 + 1);
  }
  context.textAlign = "left";
}

function bars(items, share, isBad) {
  return (context, top) => {
    for (const item of items) {
      const height = share(item) * (LANE - 2);
      if (!height) continue;
      const left = scale(item[0] - 1000), width = Math.max(1, scale(item[0]) - left), bad = isBad(item);
      context.fillStyle = bad ? context.palette.bad : context.palette.line;
      context.fillRect(left, top + LANE - 1 - height, width, height);
      if (bad) context.fillText("!", left, top + 6);
    }
  };
}

function ticks(number) {
  return (context, top) => {
    let last = -1;
    for (const [time, kind, , , , bad] of data.events) {
      const x = Math.round(scale(time));
      if (kind !== number || x === last && !bad) continue;
      last = x;
      context.fillStyle = bad ? context.palette.bad : context.palette.accent;
      context.fillRect(x - 1, bad ? top : top + 4, 2, bad ? LANE : LANE - 8);
    }
  };
}

// -- the timeline of the run ------------------------------------------------------------------------

let ofItem = null;  // the place of the item whose marks are shown; null: everything

// Show only the marks of an item, or everything again.
function showItem(item) {
  ofItem = item === ofItem ? null : item;
  $("of-item").hidden = ofItem === null;
  $("of-item").firstElementChild.textContent = ofItem === null ? "" : data.items[ofItem][1];
  draw();
}

function makeHappened() {
  $("timeline-part").hidden = data.timeline.length === 0;
  $("happened").replaceChildren(...data.timeline.map((one) => {
    const row = make("li"), button = make("button");
    button.type = "button";
    button.append(make("span", one.clock || timeOfDay(one.at).slice(0, 8), "when"),
      make("span", signOf(one), `sign ${gives(one)}`), make("span", one.text), make("b", one.points || one.change, gives(one)),
      make("small", [one.note, one.who, one.said].filter(Boolean).join(" · ")));
    button.addEventListener("click", () => seek(one.at));
    row.append(button);
    return row;
  }));
}

function drawHappened() {
  const list = $("happened"), current = lastUpTo(data.timeline, at.time, (one) => one.at);
  if (!changed("happened", [current, ofItem])) return;
  [...list.children].forEach((row, place) => {
    row.hidden = ofItem !== null && data.timeline[place].item !== ofItem;
    row.className = place > current ? "later" : "";
    row.firstChild.setAttribute("aria-current", String(place === current));
  });
  const now = list.children[current];
  if (now && !list.contains(document.activeElement)) list.scrollTop = now.offsetTop - list.clientHeight / 2;
}

// -- the list of events -----------------------------------------------------------------------------

const hidden = new Set();  // numbers of the kinds that are not in the list
let rowHeight = 32;

function filterEvents() {
  const wanted = $("search").value.trim().toLowerCase();
  shown = [];
  data.events.forEach(([, kind, who, robot, text], index) => {
    if (!hidden.has(kind) && (!wanted || `${who} ${robot} ${text}`.toLowerCase().includes(wanted))) shown.push(index);
  });
  $("count").textContent = `${shown.length} of ${data.events.length} events`;
  shownHere.delete("rows");
  $("rows").replaceChildren();  // rows of the longer list would keep it scrolled beyond its end
  $("rows").style.height = `${shown.length * rowHeight}px`;
  drawRows();
}

const whole = ([, kind, who, robot, text]) => [who, robot, text].filter(Boolean).join(": ") || data.kinds[kind];

function drawRows() {
  const list = $("list"), begin = Math.max(0, Math.floor(list.scrollTop / rowHeight) - 4);
  const end = Math.min(shown.length, begin + Math.ceil(list.clientHeight / rowHeight) + 8);
  const current = lastUpTo(shown, at.time, (index) => data.events[index][0]);
  if (!changed("rows", [begin, end, Math.max(begin - 1, Math.min(end, current)), at.chosen])) return;
  const rows = [];
  for (let place = begin; place < end; place++) {
    const index = shown[place], event = data.events[index];
    const row = make("div", undefined, place > current ? "row later" : "row");
    row.id = `event-${index}`;
    row.dataset.index = index;
    row.style.top = `${place * rowHeight}px`;
    row.setAttribute("role", "option");
    row.setAttribute("aria-selected", String(index === at.chosen));
    row.setAttribute("aria-setsize", shown.length);
    row.setAttribute("aria-posinset", place + 1);
    row.append(make("span", timeOfDay(event[0]), "when"), ` ${event[5] ? "⚠ " : ""}${data.kinds[event[1]]}: ${whole(event)}`);
    rows.push(row);
  }
  $("rows").replaceChildren(...rows);
  if (document.getElementById(`event-${at.chosen}`)) list.setAttribute("aria-activedescendant", `event-${at.chosen}`);
  else list.removeAttribute("aria-activedescendant");
}

function scrollTo(place) {
  const list = $("list"), top = place * rowHeight;
  if (top < list.scrollTop || top + rowHeight > list.scrollTop + list.clientHeight) {
    list.scrollTop = Math.max(0, top - list.clientHeight / 2);
  }
}

// Choose an event, and jump to it.
function choose(index) {
  if (index === undefined) return;
  at.chosen = index;
  const event = data.events[index];
  $("whole").textContent = `${timeOfDay(event[0])} ${data.kinds[event[1]]}: ${whole(event)}`;
  scrollTo(shown.indexOf(index));
  seek(event[0]);
  drawRows();
  drawVideo();
}

// Choose the next event of the list (1), or the previous one (-1).
function chooseNext(by) {
  const place = shown.indexOf(at.chosen);
  const isThere = place >= 0 && Math.min(data.length, Math.max(0, data.events[at.chosen][0])) === at.time;
  const current = lastUpTo(shown, at.time, (index) => data.events[index][0]);
  const before = current >= 0 && data.events[shown[current]][0] === at.time ? current - 1 : current;
  choose(shown[isThere ? place + by : by > 0 ? current + 1 : before]);
}

// -- time -------------------------------------------------------------------------------------------

function seek(moment) {
  at.time = Math.min(data.length, Math.max(0, moment));
  if (at.time >= data.length) setPlaying(false);
  draw();
  followVideo(true);
}

function setPlaying(playing) {
  if (playing && at.time >= data.length) at.time = 0;
  at.playing = playing;
  $("play").textContent = playing ? "‖ Pause" : "▶ Play";
  $("play").setAttribute("aria-pressed", String(playing));
  followVideo(true);
  if (playing) {
    let last = performance.now();
    const step = (now) => {
      if (!at.playing) return;
      at.time = Math.min(data.length, at.time + Math.max(0, now - last) * at.speed);
      last = now;
      if (at.time >= data.length) setPlaying(false);
      draw();
      followVideo(false);
      if (at.playing) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }
}

function setSpeed(speed) {
  at.speed = speed;
  $("speed").value = String(speed);
  followVideo(true);
}

function draw() {
  const moment = at.time;
  $("time").textContent = `${timeOfDay(moment)} ${offsetText} (${duration(moment / 1000)} of ${duration(data.length / 1000)})`;
  $("slider").value = moment;
  $("slider").setAttribute("aria-valuetext", `${timeOfDay(moment)}, ${duration(moment / 1000)} after connect`);
  $("cursor").style.transform = `translateX(${scale(moment)}px)`;
  drawState();
  drawHappened();
  if (at.playing) {
    const current = lastUpTo(shown, moment, (index) => data.events[index][0]);
    if (changed("current", current) && current >= 0 && document.activeElement !== $("list")) scrollTo(current);
  }
  drawRows();
  say();
}

// -- the video --------------------------------------------------------------------------------------

function showVideo(address, name) {
  const video = $("video");
  offset = null;
  video.hidden = false;
  video.src = address;
  video.setAttribute("aria-label", `Video ${name}`);
  drawVideo();
}

function drawVideo() {
  const there = !$("video").hidden;
  $("sync").disabled = !there || at.chosen < 0;
  $("unsync").disabled = offset === null;
  $("synced").textContent = !there ? "" : offset === null
    ? "Pause the video where it shows an event, choose this event in the list, then press the button."
    : `The video begins ${duration(Math.abs(offset) / 1000)} ${offset < 0 ? "before" : "after"} connect. It follows the replay.`;
}

// Make the video show the moment of the replay.
function followVideo(jumped) {
  const video = $("video");
  if (offset === null || video.hidden || !(video.duration > 0)) return;
  const wanted = (at.time - offset) / 1000, inside = wanted >= 0 && wanted < video.duration;
  const plays = at.playing && inside && at.speed <= MAX_VIDEO_SPEED;
  if (jumped || Math.abs(video.currentTime - wanted) > APART_S * Math.max(1, at.speed)) {
    video.currentTime = Math.min(video.duration, Math.max(0, wanted));
  }
  if (plays) {
    video.playbackRate = at.speed;
    if (video.paused) video.play().catch(() => {});
  } else if (!video.paused) video.pause();
}

// -- the user ---------------------------------------------------------------------------------------

function onKey(event) {
  const target = event.target, isField = target.matches("input:not([type=checkbox]):not([type=range]), select, video");
  if (isField || event.ctrlKey || event.altKey || event.metaKey) return;
  const inList = target === $("list"), isButton = target.matches("button, input[type=checkbox]");
  const actions = {
    " ": () => setPlaying(!at.playing), ArrowLeft: () => seek(at.time - STEP_MS), ArrowRight: () => seek(at.time + STEP_MS),
    Home: () => inList ? choose(shown[0]) : seek(0),
    End: () => inList ? choose(shown[shown.length - 1]) : seek(data.length),
    ",": () => chooseNext(-1), ".": () => chooseNext(1),
    "+": () => setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, SPEEDS.indexOf(at.speed) + 1)]),
    "-": () => setSpeed(SPEEDS[Math.max(0, SPEEDS.indexOf(at.speed) - 1)]),
  };
  if (inList) Object.assign(actions, { ArrowUp: () => chooseNext(-1), ArrowDown: () => chooseNext(1) });
  const action = event.key === " " && isButton ? undefined : actions[event.key];
  if (!action) return;
  event.preventDefault();
  action();
}

function begin() {
  document.title = `Replay: ${data.title}`;
  $("title").textContent = data.title;
  $("facts").replaceChildren(...data.facts.flatMap(([name, value]) => [make("dt", name), make("dd", value)]));
  $("missing").hidden = data.clock.length > 0;
  $("slider").max = data.length;
  SPEEDS.forEach((speed) => $("speed").append(new Option(`${speed}×`, speed, speed === 1, speed === 1)));
  data.robots.forEach((robot, number) => $("robot").append(new Option(robot.name, number)));
  $("choose-robot").hidden = data.robots.length < 2;
  data.kinds.forEach((kind, number) => {
    const label = make("label"), box = make("input");
    box.type = "checkbox";
    box.checked = true;
    box.addEventListener("change", () => {
      if (box.checked) hidden.delete(number); else hidden.add(number);
      filterEvents();
    });
    label.append(box, kind);
    $("filters").append(label);
  });
  rowHeight = ROW_EM * parseFloat(getComputedStyle($("list")).fontSize);

  makeHappened();
  $("of-item").lastElementChild.addEventListener("click", () => showItem(null));
  $("play").addEventListener("click", () => setPlaying(!at.playing));
  $("before").addEventListener("click", () => chooseNext(-1));
  $("after").addEventListener("click", () => chooseNext(1));
  $("slider").addEventListener("input", () => seek(Number($("slider").value)));
  $("speed").addEventListener("change", () => setSpeed(Number($("speed").value)));
  $("robot").addEventListener("change", () => {
    at.robot = Number($("robot").value);
    drawPicture();
    draw();
  });
  $("search").addEventListener("input", filterEvents);
  $("list").addEventListener("scroll", drawRows, { passive: true });
  $("rows").addEventListener("click", (event) => {
    const row = event.target.closest(".row");
    if (row) choose(Number(row.dataset.index));
  });
  $("lanes").addEventListener("click", (event) => {
    const left = $("lanes").getBoundingClientRect().left;
    seek((event.clientX - left - LEFT) / ($("lanes").clientWidth - LEFT - 2) * data.length);
  });
  $("file").addEventListener("change", () => {
    const [file] = $("file").files;
    if (!file) return;
    if (objectUrl) URL.revokeObjectURL(objectUrl);
    objectUrl = URL.createObjectURL(file);
    showVideo(objectUrl, file.name);
  });
  $("sync").addEventListener("click", () => {
    offset = data.events[at.chosen][0] - $("video").currentTime * 1000;
    drawVideo();
    seek(data.events[at.chosen][0]);
  });
  $("unsync").addEventListener("click", () => {
    offset = null;
    drawVideo();
  });
  $("video").addEventListener("error", () => {
    $("synced").textContent = "This browser cannot show the video: check the address, or convert it to MP4 (H.264) or WebM.";
  });
  document.addEventListener("keydown", onKey);
  window.addEventListener("resize", () => {
    drawPicture();
    draw();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawPicture);
  if (data.video) showVideo(data.video, data.video);
  drawVideo();
  drawPicture();
  filterEvents();
  draw();
  const wanted = Number(location.hash.slice(1));
  if (wanted > 0) seek(momentOf(wanted));
}

begin();
