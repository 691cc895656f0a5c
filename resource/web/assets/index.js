// The first page: what happens now, and the ways to all other pages.

import {Clock, Icon, Progress, State, TeamMark, Trouble, address, html, show, troubleText} from "/assets/parts.js";

const DATA = ["state", "schedule", "results", "standings", "explained"];

const Way = ({icon, to, title, how, now}) => html`
  <a class="card" href=${to}><${Icon} name=${icon} /><h2>${title}</h2><p class="quiet">${how}</p><p class="now">${now}</p></a>`;

const Links = ({title, links}) => html`
  <dt>${title}</dt><dd>${links.map(([text, to]) => html`<a href=${to}>${text}</a>`)}</dd>`;

function Index({live, words}) {
  document.title = words.title || "RoAH RSBB";
  const {runs} = live.data["page.runs"], {lines} = live.data["page.next"], done = live.data["page.results"].results;
  const [next] = lines;
  const zones = [...new Set([...runs, ...lines].map((line) => line.zone))].sort();
  const teams = [...new Set([...runs.flatMap((run) => run.teams), ...[...lines, ...done].map((line) => line.of_team)])]
    .filter((team) => team !== "ALL").sort((one, other) => one.localeCompare(other));
  const perZone = (path) => [
    [words.all_zones, address(path)],
    ...(zones.length > 1 ? zones.map((zone) => [zone, address(path, {zone})]) : []),
  ];
  const count = (text, number) => text.replace("{number}", () => number);
  const soon = next && `${words.next}: ${[next.time, next.team, next.benchmark, next.last].filter(Boolean).join(" · ")}`;
  return html`
    <${Trouble} text=${troubleText(live, words)} />
    <header class="head">
      ${words.logos.includes("competition") && html`<${TeamMark} team="competition" live=${live} />`}
      <div><h1>${words.title || "RoAH RSBB"}</h1><p class="quiet">${words.date}</p></div>
    </header>
    <section>
      <h2 class="unseen">${words.runs}</h2>
      ${runs.length > 0 ? html`<ul class="panel live">${runs.map((run) => html`
        <li key=${run.zone} class=${run.look}>
          <span class="zone-name">${run.zone}</span><${State} run=${run} />
          <span><b class="team">${run.team}</b><small class="quiet">${run.benchmark}</small></span>
          <${Progress} run=${run} live=${live} /><${Clock} run=${run} live=${live} />
        </li>`)}</ul>` : html`
        <div class="panel empty"><p><b>${words.nothing_runs}</b></p>${soon && html`<p>${soon}</p>`}<p class="quiet">${words.zones_here}</p></div>`}
    </section>
    <nav class="ways">
      <${Way} icon="watch" to=${address("/display")} title=${words.watch} how=${words.watch_how}
        now=${runs.length || !next ? count(words.watch_now, runs.filter(({look}) => look === "executing").length) : `${words.next}: ${next.time}`} />
      <${Way} icon="referee" to=${address("/referee")} title=${words.referee} how=${words.referee_how} now=${words.referee_now} />
      <${Way} icon="team" to="#teams" title=${words.team} how=${words.team_how} now=${count(words.team_now, teams.length)} />
      <${Way} icon="organise" to=${address("/box")} title=${words.organise} how=${words.organise_how}
        now=${next && next.planned ? `${words.next}: ${words.late.replace("{time}", () => next.time).replace("{planned}", () => next.planned)}` : count(words.organise_now, lines.length)} />
    </nav>
    <section id="teams">
      <h2>${words.teams}</h2>
      <ul class="teams">${teams.map((team) => html`
        <li><a href=${address(`/team/${encodeURIComponent(team)}`)}><${TeamMark} team=${team} live=${live} /><span>${team}</span></a></li>`)}</ul>
      ${teams.length === 0 && html`<p class="quiet">${words.teams_here}</p>`}
    </section>
    <section>
      <h2>${words.more}</h2>
      <dl class="links">
        <${Links} title=${words.display} links=${[...perZone("/display"), [words.displays_page, address("/displays")]]} />
        <${Links} title=${words.overlay} links=${perZone("/overlay")} />
        <${Links} title=${words.teams} links=${[[words.pair_page, address("/pair")], [words.codes_page, address("/codes")]]} />
        <${Links} title=${words.data} links=${DATA.map((name) => [name, `/api/v1/${name}`])} />
      </dl>
    </section>`;
}

show(Index);
