// Slide to unlock: what a pocket or a hand touches on a page that lay idle has no effect. STOP stays beside it.

// A referee who only watches a run touches nothing for minutes. Phones switch their screens off sooner, and then the page
// is locked at once.
const IDLE_MS = 180000;
const LOOK_MS = 1000;
const FAR = 0.85;  // how much of the way the slide must go
const TOUCHED = "roah_rsbb_touched";

// Locks the page `place` when it lay idle or its phone slept. `texts()`: those of the page. In a run (`isRunning()`) it may
// lie idle, and the cover lets the clock be seen. Returns a function for the text that the cover must not hide.
export function lockWhenIdle(place, texts, isRunning) {
  const cover = document.createElement("div"), track = document.createElement("div"), knob = document.createElement("button");
  const title = document.createElement("p"), hint = document.createElement("span");
  cover.className = "lock";
  track.className = "track";
  knob.type = "button";
  knob.textContent = "▶▶";
  const urgent = document.createElement("p");
  urgent.className = "urgent";
  cover.append(urgent, title, track);
  track.append(hint, knob);
  cover.hidden = true;
  document.body.append(cover);

  const setLocked = (isLocked) => {
    if (cover.hidden === isLocked) {
      const {locked = "Locked. STOP works", unlock = "Slide to unlock"} = texts() || {};
      title.textContent = locked;
      hint.textContent = unlock;
      knob.setAttribute("aria-label", unlock);
      knob.style.transform = "";
      cover.hidden = !isLocked;
      place.inert = isLocked;
    }
  };

  // A tab that its phone has thrown away in its sleep is loaded again: it was touched long ago, too.
  const read = () => {
    try {
      return Number(sessionStorage.getItem(TOUCHED));
    } catch (error) {
      return 0;
    }
  };
  let touched = read() || Date.now();
  const touch = () => {
    touched = Date.now();
    try {
      sessionStorage.setItem(TOUCHED, touched);
    } catch (error) {
      // The browser refuses its storage: such a tab is not locked after it was loaded again.
    }
  };
  ["pointerdown", "keydown"].forEach((kind) => window.addEventListener(kind, touch, true));
  const look = () => {
    const isInRun = isRunning();
    cover.classList.toggle("clear", isInRun);
    if (Date.now() - touched > IDLE_MS) {
      setLocked(true);
    } else if (isInRun) {
      touched = Date.now();
    }
  };
  setInterval(look, LOOK_MS);
  window.addEventListener("wake", () => (look(), setLocked(true)));
  look();

  // One finger slides: a hand that lies on the page moves with several contacts.
  let begin = null;
  const contacts = new Set();
  const end = () => {
    begin = null;
    knob.style.transform = "";
  };
  cover.addEventListener("pointerdown", (event) => {
    contacts.add(event.pointerId);
    if (contacts.size > 1) {
      end();
    } else if (event.target === knob) {
      begin = event.clientX;
      knob.setPointerCapture(event.pointerId);
    }
  });
  knob.addEventListener("pointermove", (event) => {
    if (begin === null) {
      return;
    }
    const way = track.clientWidth - knob.offsetWidth;
    const moved = Math.max(0, Math.min(way, event.clientX - begin));
    knob.style.transform = `translateX(${moved}px)`;
    if (moved >= FAR * way) {
      end();
      contacts.clear();
      setLocked(false);
    }
  });
  ["pointerup", "pointercancel"].forEach((kind) => window.addEventListener(kind, (event) => {
    contacts.delete(event.pointerId);
    end();
  }));
  knob.addEventListener("click", (event) => event.detail === 0 && setLocked(false));  // a key, or a screen reader
  return (text) => urgent.textContent === text || (urgent.textContent = text);
}
