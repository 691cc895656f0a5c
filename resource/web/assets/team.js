// What is public about a team. Its name is the end of the address.

import {Card, Line, html, show, troubleText} from "/assets/parts.js";

const ALL = "ALL";

function teamName() {
  try {
    return decodeURIComponent(location.pathname.split("/").pop());
  } catch (error) {
    return "";
  }
}

function Part({title, lines, nothing}) {
  return html`
    <section class="below">
      <h2>${title}</h2>
      <ul>${lines.map((line) => html`<${Line} line=${line} />`)}</ul>
      ${lines.length === 0 && html`<p class="nothing">${nothing}</p>`}
    </section>`;
}

function Team({live, words}) {
  const name = teamName();
  const isOurs = (line) => line.of_team === name || line.of_team === ALL;
  document.title = name;
  document.body.dataset.layout = "list";
  if (!live.data["page.runs"]) {
    return html`<h1 class="title">${name}</h1><p class="waiting">${words.waiting}</p>`;
  }
  const runs = live.data["page.runs"].runs.filter((run) => run.teams.includes(name));
  const following = live.data["page.next"].lines.filter(isOurs);
  const {results, provisional} = live.data["page.results"];
  const ours = results.filter(isOurs), early = provisional.filter(isOurs);
  const standings = live.data["page.standings"].standings
    .map((standing) => ({title: standing.title, lines: standing.lines.filter((line) => line.team === name)}))
    .filter((standing) => standing.lines.length > 0);
  const trouble = troubleText(live, words);
  return html`
    ${trouble && html`<header class="alarm"><span role="alert">${trouble}</span></header>`}
    <h1 class="title">${name}</h1>
    ${runs.length > 0 && html`
      <section class="cards">
        <h2 class="unseen">${words.runs}</h2>
        ${runs.map((run) => html`<${Card} key=${run.zone} run=${run} live=${live} />`)}
      </section>`}
    ${![runs, following, ours, early, standings].some((found) => found.length) && html`
      <p class="nothing">${words.not_in_schedule}</p>`}
    <${Part} title=${words.next} lines=${following} nothing=${words.no_events} />
    ${standings.map((standing) => html`<${Part} ...${standing} nothing="" />`)}
    <${Part} title=${words.results} lines=${ours} nothing=${words.no_results} />
    ${early.length > 0 && html`<${Part} title=${words.provisional} lines=${early} nothing="" />`}`;
}

show(Team);
