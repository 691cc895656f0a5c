// The overlay for video: a lower third on a transparent page. ?zone=…, ?results=1 shows the newest result between runs.

import {Ticking, bigText, html, isChosen, parameters, show, troubleText} from "/assets/parts.js";

function Overlay({live, words}) {
  document.title = words.overlay;
  const heading = html`<h1 class="unseen">${words.overlay}</h1>`;
  if (!live.data["page.runs"]) {
    return heading;
  }
  const run = live.data["page.runs"].runs.filter(isChosen)[0];
  const trouble = troubleText(live, words);
  if (run) {
    return html`
      ${heading}
      <div class="third ${run.phase} ${run.is_paused ? "paused" : ""}">
        <div class="who"><b class="team">${run.team}</b> <span class="benchmark">${run.benchmark}</span></div>
        <div class="when">
          <${Ticking} class="big" make=${() => bigText(run, live.now())} />
          <span class="word" role="status">${trouble || run.word}</span>
        </div>
      </div>`;
  }
  const result = parameters.get("results") === "1" && live.data["page.results"].results.filter(isChosen)[0];
  return html`
    ${heading}
    ${result && html`
      <div class="third ended">
        <div class="who"><b class="team">${result.team}</b> <span class="benchmark">${result.benchmark}</span></div>
        <div class="when"><span class="word">${result.last}</span></div>
        <div class="scores">${result.scores.join(" · ")}</div>
      </div>`}`;
}

show(Overlay, undefined, "overlay");
