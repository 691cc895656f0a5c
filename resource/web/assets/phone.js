// What browsers let only a page do that is encrypted with a certificate which they trust: open without a network, keep the
// screen on, be installed (docs/web.md, "Without a link").

import {html, useEffect, useState} from "/assets/parts.js";

// Whether the pages open without a network, as soon as that is known. Browsers refuse it where somebody only went past
// their warning of the certificate.
const isKept = location.protocol === "https:" && navigator.serviceWorker
  ? navigator.serviceWorker.register("/worker.js", {updateViaCache: "none"}).then((worker) => {
    worker.update().catch(() => {});  // browsers look for another version only at times; without a network, they cannot
    return true;
  }, () => false)
  : Promise.resolve(isSecureContext);

// What is missing on this device, and the remedy.
export function Missing({texts}) {
  const [isTrusted, setTrusted] = useState(true);
  useEffect(() => {
    isKept.then(setTrusted);
  }, []);
  const missing = !isSecureContext ? texts.needs_certificate : isTrusted ? "" : texts.needs_trust;
  return missing && html`<p class="nothing quiet missing">${missing}</p>`;
}

let lock = null, isNeeded = false;

// Keep the screen on, or no longer. The browser ends it whenever the page is hidden.
export async function stayAwake(isWanted) {
  isNeeded = isWanted;
  if (!navigator.wakeLock || lock === "asked" || document.visibilityState !== "visible" || isWanted === Boolean(lock)) {
    return;
  }
  if (!isWanted) {
    lock.release();
    lock = null;
    return;
  }
  lock = "asked";
  lock = await navigator.wakeLock.request("screen").catch(() => null);  // a phone whose battery is low refuses
  lock && lock.addEventListener("release", () => (lock = null));
  lock && stayAwake(isNeeded);
}
document.addEventListener("visibilitychange", () => stayAwake(isNeeded));
