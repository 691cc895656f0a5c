// The tablet's page: shows the messages of the tablet's node and sends it every touch. The node decides.
"use strict";

const HERE_PERIOD_MS = 2000;
const RECONNECT_MS = 1000;
// The node sends a message each second.
const NODE_SILENT_MS = 4000;
const KEY_STEP = 0.02;
const REFUSED_MS = 5000;

const parts = {};
for (const id of ["call-view", "call", "map-view", "frame", "sheet", "map", "no-map", "mark", "cross", "said", "alarm"]) {
  parts[id] = document.getElementById(id);
}

let connection = null;
let state = null;  // the node's last message
let stateAt = -Infinity;
let refused = "";
let refusedAt = -Infinity;
let cross = null;  // position selected with the keyboard
let severalFingers = false;

function connect() {
  const scheme = location.protocol === "https:" ? "wss:" : "ws:";
  const opening = new WebSocket(`${scheme}//${location.host}/pages`);
  connection = opening;
  opening.onopen = () => say({do: "here"});
  opening.onmessage = (event) => receive(JSON.parse(event.data));
  opening.onclose = () => {
    if (connection === opening) {
      connection = null;
      stateAt = -Infinity;
      show();
      setTimeout(connect, RECONNECT_MS);
    }
  };
}

function say(message) {
  if (connection && connection.readyState === WebSocket.OPEN) {
    connection.send(JSON.stringify(message));
  }
}

function receive(message) {
  if (message.refused) {
    refused = message.refused;
    refusedAt = performance.now();
  } else {
    state = message;
    stateAt = performance.now();
  }
  show();
}

function watch() {
  // A lost connection sends nothing, and the browser notices it only after minutes.
  if (connection && connection.readyState === WebSocket.OPEN && performance.now() - stateAt > NODE_SILENT_MS) {
    connection.close();
    connection.onclose();
  }
  show();
}

function hasNode() {
  return performance.now() - stateAt <= NODE_SILENT_MS;
}

function isUsable() {
  return hasNode() && state.box;
}

function touch(message) {
  if (isUsable()) {
    refused = "";
    say(message);
  }
}

// -- showing -----------------------------------------------------------------------------------------

function show() {
  const alarm = alarmText();
  document.body.classList.toggle("off", alarm !== "");
  set(parts.alarm, alarm);
  parts.alarm.hidden = alarm === "";
  parts.call.disabled = !isUsable();
  const view = state ? state.view : "call";
  parts["call-view"].hidden = view !== "call";
  parts["map-view"].hidden = view !== "map";
  showMap();
  set(parts.said, saidText(view));
  document.body.dataset.view = view;
}

function alarmText() {
  if (!hasNode()) {
    return "No connection: check the network. Nothing can be sent now.";
  }
  return state.box ? "" : "The referee's box is silent. Nothing can be sent now.";
}

function saidText(view) {
  if (refused && performance.now() - refusedAt < REFUSED_MS) {
    return refused;
  }
  if (!state) {
    return "";
  }
  if (view === "call") {
    return outcome(state.call, "Call", "The robot was called", "");
  }
  const place = state.place;
  const where = `x ${place.x.toFixed(2)} m, y ${place.y.toFixed(2)} m`;
  return outcome(place, "Position", `Position sent: ${where}`, "Touch where the robot should go.");
}

function outcome(touched, name, done, nothing) {
  if (!touched.time) {
    return nothing;
  }
  const time = new Date(touched.time).toLocaleTimeString([], {hour12: false});
  if (touched.acknowledged) {
    return `✓ ${done} (${time})`;
  }
  return state.unanswered ? `${name} of ${time} not confirmed by the box. Is another tablet on?` : `${name} is being sent …`;
}

function showMap() {
  const plan = state && state.map;
  parts["no-map"].hidden = Boolean(plan);
  parts.sheet.hidden = !plan;
  if (!plan || parts["map-view"].hidden) {
    return;
  }
  if (parts.map.getAttribute("src") !== plan.image) {
    parts.map.src = plan.image;
  }
  parts.map.classList.toggle("negate", plan.negate);
  const scale = Math.min(parts.frame.clientWidth / plan.width, parts.frame.clientHeight / plan.height);
  parts.sheet.style.width = `${plan.width * scale}px`;
  parts.sheet.style.height = `${plan.height * scale}px`;
  const place = state.place;
  putAt(parts.mark, place.time ? place : null);
  parts.mark.classList.toggle("waiting", !place.acknowledged);
  putAt(parts.cross, cross);
}

function putAt(element, point) {
  element.hidden = !(point && point.u >= 0 && point.u <= 1 && point.v >= 0 && point.v <= 1);
  if (!element.hidden) {
    element.style.left = `${point.u * 100}%`;
    element.style.top = `${point.v * 100}%`;
  }
}

function set(element, text) {
  if (element.textContent !== text) {  // otherwise screen readers read it each second
    element.textContent = text;
  }
}

// -- touching ----------------------------------------------------------------------------------------

function fraction(at, start, size) {
  return Math.min(1, Math.max(0, (at - start) / size));
}

parts.call.addEventListener("click", () => touch({do: "call"}));

// Select the position where the finger is lifted, so that users can slide to it. Two fingers zoom and select nothing.
parts.sheet.addEventListener("pointerdown", (event) => {
  severalFingers = !event.isPrimary;
});
parts.sheet.addEventListener("pointerup", (event) => {
  const box = parts.sheet.getBoundingClientRect();
  if (event.isPrimary && event.button === 0 && !severalFingers) {
    cross = null;
    touch({do: "place", u: fraction(event.clientX, box.left, box.width), v: fraction(event.clientY, box.top, box.height)});
  }
});

parts.sheet.addEventListener("keydown", (event) => {
  const step = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
  if (step) {
    const from = cross || {u: 0.5, v: 0.5};
    cross = {u: fraction(from.u + step[0] * KEY_STEP, 0, 1), v: fraction(from.v + step[1] * KEY_STEP, 0, 1)};
  } else if (event.key === "Enter" && cross) {
    touch({do: "place", ...cross});
  } else {
    return;
  }
  event.preventDefault();
  show();
});

document.addEventListener("contextmenu", (event) => event.preventDefault());
// Without this, Safari on iOS zooms with two fingers.
document.addEventListener("gesturestart", (event) => event.preventDefault());
window.addEventListener("resize", show);
setInterval(() => say({do: "here"}), HERE_PERIOD_MS);
setInterval(watch, 500);
connect();
show();
