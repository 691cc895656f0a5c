// The worker of the pages of paired devices: opens them without a network (docs/web.md, "Without a link"). The gateway
// writes before it which FILES the box's pages consist of, and their VERSION: the files of another box make another worker,
// which replaces what is kept.

// A network that answers nothing for so long is no network.
const SLOW_MS = 3000;
const TOO_MANY = 429;

// One after the other: the box limits how many requests a phone makes.
async function keepAll() {
  const kept = await caches.open(VERSION), left = [...FILES];
  while (left.length > 0) {
    const answer = await fetch(left[0], {cache: "reload"});
    if (answer.ok) {
      await kept.put(left.shift(), answer);
    } else if (answer.status === TOO_MANY) {
      await new Promise((done) => setTimeout(done, SLOW_MS));
    } else {
      throw new Error(`${left[0]}: ${answer.status}`);  // the next page that is opened tries again
    }
  }
}

addEventListener("install", (event) => {
  skipWaiting();
  event.waitUntil(keepAll());
});

addEventListener("activate", (event) => event.waitUntil(caches.keys()
  .then((names) => Promise.all(names.filter((name) => name !== VERSION).map((name) => caches.delete(name))))
  .then(() => clients.claim())));

// What the box sends now, or what is kept.
async function answered(request, path) {
  const asked = fetch(request).catch(() => null);
  const kept = await caches.open(VERSION).then((all) => all.match(path));
  const found = await Promise.race([asked, ...(kept ? [new Promise((done) => setTimeout(done, SLOW_MS))] : [])]);
  return found && found.ok ? found : kept || await asked || Response.error();
}

addEventListener("fetch", (event) => {
  const {origin, pathname} = new URL(event.request.url);
  if (event.request.method === "GET" && origin === location.origin && FILES.includes(pathname)) {
    event.respondWith(answered(event.request, pathname));
  }
});
