// The overlay for video: lower thirds on a transparent page, as the organiser calls them. ?zone=…, ?show=clock, results,
// caption or nothing; ?results=1 shows the newest result between runs.

import {
  Clock, Fit, Progress, State, TeamMark, band, caption, html, isChosen, parameters, show, shown, troubleText,
} from "/assets/parts.js";

const third = (logo, name, below, rest) => html`
  <section class="lower">
    ${logo}
    <div class="who"><${Fit} class="team">${name}<//><${Fit} class="benchmark">${below}<//></div>
    ${rest}
  </section>`;

function shownNow(live, words) {
  const what = shown(), mark = (team) => html`<${TeamMark} key=${team} team=${team} live=${live} />`;
  const run = live.data["page.runs"].runs.filter(isChosen)[0];
  const result = live.data["page.results"].results.filter(isChosen)[0];
  const trouble = troubleText(live, words);
  if (what === "caption") {
    const [name, ...below] = caption().split(/\s*\|\s*/);
    return name && third(words.logos.includes("competition") && mark("competition"), name, below.join(" · "));
  }
  if (what === "clock") {
    return run && html`
      <section class="bug"><b>${run.team}</b><span class=${band(run)}><${Clock} run=${run} live=${live} /><${Progress} run=${run} live=${live} /></span></section>`;
  }
  if (run && what !== "results" && what !== "nothing") {
    return third(mark(run.team), run.team, run.benchmark, html`
      <div class="when ${band(run)}">
        <${Clock} run=${run} live=${live} /><span role="status"><${State} run=${run} word=${trouble || run.word} /></span>
        <${Progress} run=${run} live=${live} />
      </div>`);
  }
  return result && what !== "nothing" && (what === "results" || parameters.get("results") === "1")
    && third(mark(result.of_team), result.team, result.benchmark, html`
      <div class="when band completed">${result.points ? html`<b class="big">${result.points}</b><span>${words.points}</span>` : html`<${State} run=${result} word=${result.last} />`}</div>
      ${result.rank && html`<div class="when"><span>${words.rank}</span><b class="big">${result.rank}</b></div>`}`);
}

function Overlay({live, words}) {
  document.title = words.overlay;
  return html`<h1 class="unseen">${words.overlay}</h1>${shownNow(live, words)}`;
}

show(Overlay, undefined, "overlay");
