// STOP of the referee's page, and of what else a paired device opens, loaded before everything else (docs/web.md,
// "Referees"). It has its own connection, needs no other script and no text, and knows only: the zones that this device
// may stop, whether a run in them can be stopped, and whether the box is heard. The rest of the page gives it texts and
// may fail.

"use strict";
(() => {
  const AGAIN_MS = 500, ANSWER_MS = 6000, NEXT_TRY_MS = 2000;
  const ALSO_MS = 300;  // without an answer on its connection, a STOP is also sent by a request
  const MOST_SIGNS = 300;  // of a STOP on its connection: the gateway takes 1024 bytes
  const SILENT_MS = 2200, CONNECT_MS = 5000, RECONNECT_MS = 1000;
  const LATE_MS = 1000;  // as in wording/stop.py
  const HOLD_MS = 800;
  const READ_MS = 5000;  // how long the end of a STOP is shown at least
  // A STOP that names no run ends after this time without an answer: it must not stop a run of later.
  const UNKNOWN_RUN_MS = 30000;
  const REFUSED = [400, 401, 403, 409];
  const AT_ONCE = 2;  // browsers have six connections: the STOP of another zone must find one that is free
  const PALM = 2;  // more contacts than these are a hand that means STOP
  const LOOK_MS = 250, SLEPT_MS = 1000;
  const KEPT = "roah_rsbb_stops";
  const SAME_MS = 2000;  // after a press, STOP does not pass to the only other run: whoever is frightened presses twice
  const STAYS = "roah_rsbb_stays";  // marks the entry of the history that takes Back
  // The referee's page and that of the whole box. On others, STOP is shown while a run is in progress.
  const IS_OWN = document.body.classList.contains("referee");
  const words = {
    stop: "■ STOP", stop_all: "■ STOP ALL", hold: "hold", really: "Press again: {command}",
    offline: "NO LINK TO THE BOX since {time}. STOP and marks are sent until the box answers",
    superseded: "ANOTHER BOX HAS TAKEN OVER: open the pages at {address}",
    nothing_to_stop: "No run is in progress, so there is nothing to stop",
    others_run: "Nothing is running in {zone}. Running: {zones}. Choose one of them, or hold STOP ALL",
    cannot_stop: "This device is not paired, so it cannot stop a robot. A paired device, the referees' table and the robot's "
      + "emergency button can",
    stays: "Back does not leave this page while a run is in progress",
    not_stopped: "STOP was refused: {reasons}", not_paired: "This device is not paired",
    given_up: "{zone}: STOP WAS NOT DELIVERED. Stop the robot by hand, or press STOP again",
    failed: "A part of this page has failed: {part}. STOP works. Reload the page",
    stop_way: {
      sent: "STOP {zone}: sent …",
      at_box: "STOP {zone}: the box has it. Waiting for the robot …",
      stopped: "STOP {zone}: the robot has stopped",
      no_robot: "STOP {zone}: the clock is stopped. It reached no robot",
      lost_box: "STOP {zone}: NOT DELIVERED. Stop the robot by hand. Trying again …",
      lost_robot: "STOP {zone}: NO ANSWER FROM THE ROBOT. Stop it by hand. Trying again …",
    },
  };
  const URGENT = ["lost_box", "lost_robot", "not_stopped", "given_up"], DONE = ["stopped", "no_robot"];
  const page = {zones: [], all: false, successor: "", isKnown: false, isPaired: true,
    shown: new URLSearchParams(location.search).get("zone"), note: "", isUrgent: false, failures: new Map(), why: () => null,
    pressed: "", pressedAt: -Infinity, stayedAt: -Infinity, isFollowing: false};
  const stops = new Map();  // the newest one of each zone
  const asked = new Map();  // what takes the answers on the connection, by the number of the try
  const requests = new Map();  // that wait for an answer: what ends each, and its STOP
  let tries = 0;
  const link = {socket: null, startedAt: 0, openedAt: -Infinity, heardAt: -Infinity, isHeard: false, hasZones: false, number: 0,
    lostAt: Date.now()};

  // What the rest of the page gives, a browser that refuses its storage, sounds: STOP works without it.
  function tryTo(act, otherwise = null) {
    try {
      return act();
    } catch (error) {
      console.error(error);
      return otherwise;
    }
  }

  // -- the control ------------------------------------------------------------------------------------

  function element(tag, name, parent) {
    const made = document.createElement(tag);
    made.className = name;
    parent.append(made);
    return made;
  }

  document.body.classList.add("stops");
  const bar = element("footer", "stopbar device", document.body), row = element("div", "stoprow", bar);
  const said = element("p", "stopsaid", row), all = element("button", "stopall", row), one = element("button", "stop", bar);
  const label = element("span", "what", one), place = element("span", "where", one);
  const allLabel = element("span", "what", all), allHint = element("span", "where", all);
  one.type = all.type = "button";
  one.dataset.command = "stop";
  all.dataset.command = "stop_all";
  said.setAttribute("role", "alert");

  const set = (node, text) => node.textContent === text || (node.textContent = text);
  const setOff = (button, isOff) => button.getAttribute("aria-disabled") === String(isOff) || button.setAttribute("aria-disabled", isOff);
  const text = (template, values) => Object.entries(values).reduce(
    (made, [name, value]) => made.replace(`{${name}}`, () => value), String(template));
  const isLinked = () => link.socket !== null && link.isHeard && performance.now() - link.heardAt <= SILENT_MS;
  const zoneOf = (name) => page.zones.find((zone) => zone.zone === name);

  // The zone that STOP stops, as in the panels (rqt/stops.py): the one shown if a run is in progress in it, else that
  // of the only run. Undefined: none is known. Without a link, a run may have begun unnoticed.
  function target() {
    const here = zoneOf(page.shown), running = page.zones.filter((zone) => zone.running);
    const isPressed = performance.now() - page.pressedAt < SAME_MS;
    if (here && (here.running || running.length !== 1)) {
      return here;
    }
    return (isPressed && zoneOf(page.pressed)) || running[0] || page.zones[0]
      || (page.shown && !page.isKnown ? {zone: page.shown, identity: ""} : undefined);
  }

  const canStop = (zone) => Boolean(zone) && !page.successor && (!isLinked() || zone.running);

  function draw() {
    const zone = target(), canAll = page.all && page.zones.some(canStop);
    set(label, words.stop);
    set(place, zone ? zone.zone : "");
    setOff(one, !canStop(zone));
    one.hidden = !page.isPaired || (page.isKnown && page.zones.length === 0);
    set(allLabel, words.stop_all);
    set(allHint, all.classList.contains("armed") ? text(words.really, {command: ""}) : words.hold);
    setOff(all, !canAll);
    all.hidden = !page.isPaired || !page.all;
    document.body.classList.toggle("no-stop", one.hidden);
    bar.classList.toggle("of-all", page.all);
    const [line, isUrgent] = tryTo(() => saying(zone), ["", false]);
    set(said, line);
    bar.hidden = !line && (!page.isPaired || !(IS_OWN || mayMove()));
    document.body.classList.toggle("no-bar", bar.hidden);
    said.classList.toggle("alarm", isUrgent);
    said.classList.toggle("several", line.includes("\n") || (isUrgent && stops.size > 1));
  }

  // What is said, and whether it is urgent: the ways of STOPs first.
  function saying(zone) {
    const ways = [...stops.values()].map((stop) => [wayOf(stop), stop]).filter(([way]) => way);
    // Zones of which the same is said share a line: small screens have few.
    const lines = (some) => {
      const zones = {};
      for (const [way, {zone, isPaired, reasons}] of some) {
        const line = text(words.stop_way[way] || words[way], {reasons: isPaired ? (reasons || []).join("; ") : words.not_paired});
        zones[line] = [...(zones[line] || []), zone];
      }
      return Object.entries(zones).map(([line, names]) => text(line, {zone: names.join(", ")})).join("\n");
    };
    ways.sort(([way], [other]) => URGENT.includes(other) - URGENT.includes(way));
    const isNews = ([way, stop]) => !DONE.includes(way) || performance.now() - stop.at < READ_MS;
    if (ways.some(isNews)) {
      return [lines(ways), ways.some(([way]) => URGENT.includes(way))];
    }
    if (!page.isPaired) {
      return [IS_OWN ? words.cannot_stop : "", false];
    }
    if (page.successor) {
      return [text(words.superseded, {address: page.successor}), true];
    }
    if (!isLinked() && (IS_OWN || mayMove()) && (page.isKnown || performance.now() > SILENT_MS)) {
      return [text(words.offline, {time: new Date(link.lostAt).toTimeString().slice(0, 8)}), true];
    }
    if (page.failures.size > 0) {
      return [text(words.failed, {part: [...page.failures.values()].join("; ")}), true];
    }
    if (performance.now() - page.stayedAt < READ_MS) {
      return [words.stays, false];
    }
    const here = zoneOf(page.shown) || zone, others = page.zones.filter(({running}) => running);
    const [why, isUrgent] = here && !here.running && tryTo(() => page.why(here.zone), null) || ["", false];
    if (page.note) {
      return isUrgent ? [`${why}\n${page.note}`, true] : [page.note, page.isUrgent];
    }
    // Before the first message, nobody knows whether there is something to stop. On other pages, only a run is news.
    const isOff = IS_OWN && page.isKnown && zone && !zone.running;
    const off = !isOff ? "" : others.length > 0
      ? text(words.others_run, {zone: zone.zone, zones: others.map((one) => one.zone).join(", ")}) : why || words.nothing_to_stop;
    return isUrgent ? [why, true] : [lines(ways) || off, false];
  }

  // -- its connection ---------------------------------------------------------------------------------

  function connect() {
    const opening = new WebSocket(`${location.protocol === "https:" ? "wss:" : "ws:"}//${location.host}/api/v1/stop`);
    Object.assign(link, {socket: opening, startedAt: performance.now(), openedAt: Infinity});
    opening.onopen = () => (link.openedAt = performance.now());
    opening.onmessage = (event) => link.socket === opening && receive(JSON.parse(event.data));
    opening.onclose = () => lose(opening);
  }

  function lose(socket) {
    if (link.socket === socket) {
      link.socket = null;
      socket.close();
      asked.forEach((take) => take());
      setTimeout(() => link.socket || !page.isPaired || connect(), RECONNECT_MS * (1 + Math.random()));
      // The referee's page asks itself whether the device is still paired.
      IS_OWN || fetch("/api/v1/session").then(({status}) => status === 401 && strip.pair(false), () => {});
      watch();
    }
  }

  function receive(message) {
    link.heardAt = performance.now();
    if (message.type === "answer") {
      const take = asked.get(message.number);
      return take && take(message);
    }
    const sent = (message.documents || message.numbers)["page.stop"];
    if (message.documents) {
      link.number = sent.number;
      // A gateway that was just started knows nothing yet: the zones are as they were last known, so STOP stays possible.
      link.hasZones = sent.data !== null;
      if (link.hasZones) {
        Object.assign(page, {zones: sent.data.zones, all: sent.data.all, successor: sent.data.successor, isKnown: true});
      }
    } else if (sent !== link.number) {
      lose(link.socket);  // a change was lost: begin again
    }
    link.isHeard = message.heard && link.hasZones;
    stay();
    watch();
  }

  // What is said of a STOP ends when its run was left or started again. That it failed is shown long enough to be read.
  function forget() {
    for (const stop of stops.values()) {
      const zone = zoneOf(stop.zone), hasFailed = Boolean(stop.reasons) || stop.isGivenUp;
      const isOther = !zone || (stop.identity ? stop.identity !== zone.identity : hasFailed);
      const isRead = !hasFailed || performance.now() - stop.at > READ_MS;
      if (stop.isAnswered && isRead && (isOther || (stop.isOver && zone.running))) {
        stops.delete(stop.zone);
      }
    }
  }

  let wasLinked = false;
  function watch() {
    const now = performance.now();
    const state = link.socket && link.socket.readyState;
    if (link.socket && ((state === WebSocket.CONNECTING && now - link.startedAt > CONNECT_MS)
        || (state === WebSocket.OPEN && now - Math.max(link.heardAt, link.openedAt) > SILENT_MS))) {
      lose(link.socket);
    }
    if (wasLinked && !isLinked()) {
      link.lostAt = Date.now();
    }
    wasLinked = isLinked();
    if (wasLinked) {
      forget();
    }
    draw();
  }

  function renew() {
    link.heardAt = -Infinity;
    if (link.socket) {
      lose(link.socket);
      connect();
    }
  }

  // -- STOP -------------------------------------------------------------------------------------------

  function stopRun(zone, isOneOfAll = false) {
    const before = stops.get(zone.zone);
    if (before && before.identity === zone.identity && !before.isAnswered) {
      before.pressed = Date.now();
      before.asking < AT_ONCE && ask(before);  // it is being sent: at once again
      return;
    }
    repeat({zone: zone.zone, identity: zone.identity, isOneOfAll, at: performance.now(), pressed: Date.now(), asking: 0,
      isAnswered: false, isGivenUp: false, isOver: false, hasStopped: false, reasons: null, isPaired: true, wasLost: false});
    tryTo(() => signal(660, [150]));  // after it is sent: the first sound takes long on a phone
  }

  // Until the box confirms or refuses it. Only its answer ends this, never what the page shows.
  async function repeat(stop) {
    stops.set(stop.zone, stop);
    while (!stop.isAnswered) {
      // The clock of the day: the other one may be stopped while a phone sleeps.
      if (!stop.identity && Math.abs(Date.now() - stop.pressed) > UNKNOWN_RUN_MS) {
        Object.assign(stop, {isAnswered: true, isGivenUp: true, at: performance.now()});
        break;
      }
      const asked = ask(stop);
      keep();
      draw();
      // The next try does not wait for an answer that may never come.
      await Promise.race([asked, passed(NEXT_TRY_MS)]);
      if (!stop.isAnswered) {
        tryTo(() => signal(880, [200, 100, 200]));
        await passed(AGAIN_MS);
      }
    }
    keep();
    draw();
  }

  const passed = (ms) => new Promise((done) => setTimeout(done, ms));

  // Each answer counts, however late it is, and that of a try which has stopped the run counts more than a refusal.
  function answered(stop, status, body) {
    if (status === 200) {
      Object.assign(stop, {isAnswered: true, isGivenUp: false, reasons: null});
      // One that arrives late must not stop the run when it was continued.
      requests.forEach((other, timeout) => other === stop && timeout.abort());
    } else if (REFUSED.includes(status) && !stop.isAnswered) {
      Object.assign(stop, {isAnswered: true, at: performance.now(), isPaired: status !== 401,
        reasons: (body && body.reasons) || [String(status)]});
    }
    keep();
    draw();
  }

  // On the connection that is open, and if it does not answer at once, also by a request: it may be dead.
  async function ask(stop) {
    stop.asking += 1;
    await Promise.race([askHere(stop), passed(ALSO_MS)]) || stop.isAnswered || await request(stop);
    stop.asking -= 1;
  }

  const textOf = (stop, more) => JSON.stringify(
    {language: document.documentElement.lang, zone: stop.zone, identity: stop.identity, ...more});

  // Whether there was an answer; false: the connection is lost, or there is none.
  function askHere(stop) {
    const number = tries += 1, text = textOf(stop, {number});
    if (!link.socket || link.socket.readyState !== WebSocket.OPEN || text.length > MOST_SIGNS) {
      return false;
    }
    link.socket.send(text);
    return new Promise((done) => asked.set(number, (answer) => {
      asked.delete(number);
      answer && answered(stop, answer.status, answer);
      done(Boolean(answer));
    }));
  }

  async function request(stop) {
    const timeout = new AbortController();
    const timer = setTimeout(() => timeout.abort(), ANSWER_MS);
    requests.set(timeout, stop);
    try {
      const answer = await fetch("/api/v1/commands/stop", {
        method: "POST", credentials: "same-origin", cache: "no-store", signal: timeout.signal, keepalive: true,
        headers: {"Content-Type": "application/json"}, body: textOf(stop),
      });
      const body = answer.status === 200 ? null : await answer.json().catch(() => null);
      answered(stop, answer.status, body);
    } catch (error) {
      // No answer.
    } finally {
      clearTimeout(timer);
      requests.delete(timeout);
    }
  }

  // How far a STOP came (wording/stop.py), or how it failed.
  function wayOf(stop) {
    const zone = zoneOf(stop.zone), isLate = performance.now() - stop.at >= LATE_MS;
    if (stop.isGivenUp) {
      return "given_up";
    }
    if (stop.reasons) {
      return stop.isOneOfAll && !stop.identity ? "" : "not_stopped";  // without a link, also where no run was known
    }
    if (!stop.isAnswered) {
      return lost(stop, isLate, "lost_box", "sent");
    }
    if (zone && zone.by_hand) {
      return "no_robot";
    }
    if (zone && isLinked()) {  // without a link, nothing new is known of the robot
      stop.isOver = stop.isOver || !zone.running;
      stop.hasStopped = stop.isOver && !zone.not_stopped;
    }
    return stop.hasStopped ? "stopped" : lost(stop, isLate, "lost_robot", "at_box");
  }

  function lost(stop, isLate, late, way) {
    if (isLate && !stop.wasLost) {
      stop.wasLost = true;
      tryTo(() => signal(880, [200, 100, 200]));
    }
    return isLate ? late : way;
  }

  // Those that this tab did not finish continue after a reload.
  function keep() {
    const open = [...stops.values()].filter((stop) => !stop.isAnswered);
    tryTo(() => open.length > 0 ? sessionStorage.setItem(KEPT, JSON.stringify(open)) : sessionStorage.removeItem(KEPT));
  }

  // -- touches ----------------------------------------------------------------------------------------

  // A touch counts when it begins: a frightened person does not hold.
  function press() {
    const zone = target();
    if (canStop(zone)) {
      Object.assign(page, {pressed: zone.zone, pressedAt: performance.now()});
      stopRun(zone);
    } else {
      bar.classList.add("whole");  // why it is off
    }
  }

  one.addEventListener("pointerdown", press);
  one.addEventListener("click", (event) => event.detail === 0 && press());  // a key, or a screen reader
  one.addEventListener("keydown", (event) => event.repeat && event.preventDefault());
  bar.addEventListener("touchstart", (event) => {
    const contacts = [...event.touches].filter((touch) => bar.contains(touch.target));
    if (contacts.length > PALM && canStop(target())) {
      press();
    }
  }, {passive: true});
  bar.addEventListener("contextmenu", (event) => event.preventDefault());
  said.addEventListener("click", () => bar.classList.toggle("whole"));
  window.addEventListener("pointerdown", (event) => bar.contains(event.target) || bar.classList.remove("whole"), true);

  let holding = null, armed = null;
  const stopAll = () => page.zones.filter(canStop).forEach((zone) => stopRun(zone, true));
  function hold() {
    release();
    if (all.getAttribute("aria-disabled") === "false") {
      all.classList.add("held");
      holding = setTimeout(() => {
        release();
        stopAll();
      }, HOLD_MS);
    }
  }
  function release() {
    clearTimeout(holding);
    all.classList.remove("held");
  }
  const isKey = (event) => event.key === "Enter" || event.key === " ";
  all.addEventListener("pointerdown", hold);
  ["pointerup", "pointercancel", "pointerleave", "blur"].forEach((kind) => all.addEventListener(kind, release));
  all.addEventListener("keydown", (event) => isKey(event) && (event.preventDefault(), event.repeat || hold()));
  all.addEventListener("keyup", (event) => isKey(event) && (event.preventDefault(), release()));
  all.addEventListener("click", (event) => {
    if (event.detail !== 0) {
      return;
    }
    clearTimeout(armed);  // a screen reader cannot hold: it presses twice
    if (all.classList.toggle("armed")) {
      armed = setTimeout(() => (all.classList.remove("armed"), draw()), 4000);
    } else {
      stopAll();
    }
    draw();
  });

  // The bar is at the bottom of what is seen: a keyboard on the screen, or a page that is enlarged, leaves less.
  function keepInSight() {
    const {height, offsetTop} = visualViewport;
    document.documentElement.style.setProperty("--covered", `${Math.max(0, innerHeight - height - offsetTop)}px`);
  }
  ["resize", "scroll"].forEach((kind) => window.visualViewport && visualViewport.addEventListener(kind, keepInSight));

  // -- leaving the page -------------------------------------------------------------------------------

  // Whether a robot may be moving, as far as this page knows.
  const mayMove = () => page.zones.some((zone) => zone.running || zone.not_stopped)
    || [...stops.values()].some((stop) => !stop.isAnswered);
  const isTouched = () => !navigator.userActivation || navigator.userActivation.hasBeenActive;
  const isLeft = () => !IS_OWN || !page.isPaired || page.isFollowing || !mayMove();

  // Back, or a swipe from the edge of the screen, goes to the entry below this one, and that is this page, too. Browsers
  // skip entries of pages that nobody has touched: then they leave.
  function stay() {
    if (!isLeft() && !(history.state && history.state[STAYS])) {
      history.pushState({[STAYS]: true}, "");
    }
  }
  window.addEventListener("popstate", ({state}) => {
    if (state && state[STAYS]) {
      return;
    }
    if (isLeft()) {
      history.back();
    } else {
      page.stayedAt = performance.now();
      history.forward();
    }
    draw();
  });
  // What leaves the page otherwise is asked by the browser. The own pages have STOP: to them, nobody is asked.
  window.addEventListener("click", ({target}) => {
    const way = target instanceof Element && target.closest("a[href]");
    page.isFollowing = Boolean(way) && way.origin === location.origin;
    setTimeout(() => (page.isFollowing = false), LATE_MS);
  });
  window.addEventListener("beforeunload", (event) => {
    if (!isLeft() && isTouched()) {
      event.preventDefault();
      event.returnValue = true;
    }
  });

  // -- sounds, sleep, faults --------------------------------------------------------------------------

  // Phones make sounds only after a touch, and iPhones only if the sound was allowed while they were touched.
  let audio = null;
  window.addEventListener("click", () => tryTo(() => {
    audio = audio || new AudioContext();
    if (audio.state !== "running") {
      audio.resume();
    }
  }));

  // A short tone, and a vibration where there is one.
  function signal(frequency, pattern) {
    if (navigator.vibrate && isTouched()) {
      navigator.vibrate(pattern);
    }
    audio = audio || new AudioContext();
    pattern.forEach((ms, number) => {
      if (number % 2 === 0) {
        const begin = audio.currentTime + pattern.slice(0, number).reduce((sum, each) => sum + each, 0) / 1000;
        const tone = audio.createOscillator(), volume = audio.createGain();
        tone.frequency.value = frequency;
        volume.gain.value = 0.3;
        tone.connect(volume).connect(audio.destination);
        tone.start(begin);
        tone.stop(begin + ms / 1000);
      }
    });
  }

  // While a phone or laptop sleeps, the clock of its pages may be stopped, so they notice no silence.
  let slept = Date.now() - performance.now();
  function wake() {
    renew();
    window.dispatchEvent(new Event("wake"));
  }
  setInterval(() => {
    const now = Date.now() - performance.now();
    if (Math.abs(now - slept) > SLEPT_MS) {
      wake();
    }
    slept = now;
    watch();
  }, LOOK_MS);
  document.addEventListener("visibilitychange", () => document.visibilityState === "visible" && wake());
  window.addEventListener("offline", renew);
  // Only a request outlives the page.
  window.addEventListener("pagehide", () => stops.forEach((stop) => stop.isAnswered || request(stop)));

  function failed(part, error) {
    console.error(part, error);
    page.failures.set(part, `${part} (${error && error.message || error})`);
    draw();
  }
  window.addEventListener("error", (event) => event.error && failed(String(event.filename).split("/").pop(), event.error));
  window.addEventListener("unhandledrejection", (event) => failed("", event.reason));

  // What the rest of the page may say.
  window.strip = {
    failed, signal: (...how) => tryTo(() => signal(...how)),
    works: (part) => page.failures.delete(part) && draw(),
    // A zone with a run that is not shown.
    other: () => tryTo(() => page.zones.find((zone) => zone.running && zone.zone !== page.shown).zone, ""),
    // The zone that is shown.
    show: (zone) => {
      page.shown = zone;
      draw();
    },
    // Whether the device is paired: otherwise it can stop nothing.
    pair: (isPaired) => {
      page.isPaired = isPaired;
      link.socket || !isPaired || connect();
      draw();
    },
    // The texts in the reader's language. `why(zone)`: why STOP is off, and whether that is urgent.
    speak: (texts, why) => {
      for (const name of Object.keys(words)) {
        words[name] = typeof texts[name] === typeof words[name] ? texts[name] : words[name];
      }
      page.why = why;
      draw();
    },
    note: (line, isUrgent = false) => {
      Object.assign(page, {note: line, isUrgent});
      draw();
    },
  };

  draw();
  connect();
  for (const kept of tryTo(() => JSON.parse(sessionStorage.getItem(KEPT))) || []) {
    repeat({...kept, at: performance.now(), asking: 0});
  }
})();
