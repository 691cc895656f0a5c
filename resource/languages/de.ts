<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de" sourcelanguage="en">
<context>
    <name>QPlatformTheme</name>
    <message>
        <source>OK</source>
        <translation>OK</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>&amp;Yes</source>
        <translation>&amp;Ja</translation>
    </message>
    <message>
        <source>&amp;No</source>
        <translation>&amp;Nein</translation>
    </message>
</context>
<context>
    <name>roah_rsbb</name>
    <message>
        <location filename="../../src/roah_rsbb/wording/clock.py"/>
        <source>PAUSED</source>
        <translation>PAUSIERT</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/clock.py"/>
        <source>Time left after the stop: {time}</source>
        <translation>Restzeit nach dem Stopp: {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/clock.py"/>
        <source>Final time of the run</source>
        <translation>Endzeit des Laufs</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/clock.py"/>
        <source>Time limit of a goal</source>
        <translation>Zeitlimit eines Ziels</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/clock.py"/>
        <source>Time limit of the run</source>
        <translation>Zeitlimit des Laufs</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/clock.py"/>
        <source>Goal: time left</source>
        <translation>Ziel: Restzeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/clock.py"/>
        <source>Used: {time} of {limit}</source>
        <translation>Verbraucht: {time} von {limit}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/clock.py"/>
        <source>Run: time left</source>
        <translation>Lauf: Restzeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/module_scores.py"/>
        <source>Whole run</source>
        <translation>Ganzer Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/module_scores.py"/>
        <source>yes</source>
        <translation>ja</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/module_scores.py"/>
        <source>no</source>
        <translation>nein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>● connected</source>
        <translation>● verbunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>▶ running</source>
        <translation>▶ läuft</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>■ ended</source>
        <translation>■ beendet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>→ next</source>
        <translation>→ als Nächstes</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>later</source>
        <translation>später</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>– skipped</source>
        <translation>– übersprungen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>✓ done: {end}</source>
        <translation>✓ erledigt: {end}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>{state} (before: {end})</source>
        <translation>{state} (vorher: {end})</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>+{minutes} min</source>
        <translation>+{minutes} min</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>+{hours} h {minutes:02d} min</source>
        <translation>+{hours} h {minutes:02d} min</translation>
    </message>
    <message numerus="yes">
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>+{n} days</source>
        <translation>
            <numerusform>+{n} Tag</numerusform>
            <numerusform>+{n} Tage</numerusform>
        </translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>to come</source>
        <translation>noch offen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>skipped</source>
        <translation>übersprungen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>no events</source>
        <translation>keine Termine</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>all</source>
        <translation>alle</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>not signed off</source>
        <translation>nicht abgeschlossen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>without a result</source>
        <translation>ohne Ergebnis</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>A run is running in {zone}. Stop it first.</source>
        <translation>In {zone} läuft ein Lauf. Stoppen Sie ihn zuerst.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>A run is connected in {zone}. Disconnect it first.</source>
        <translation>In {zone} ist ein Lauf verbunden. Trennen Sie ihn zuerst.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>{zone} is at this event already.</source>
        <translation>{zone} ist bereits bei diesem Termin.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>not attempted</source>
        <translation>nicht versucht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>corrected</source>
        <translation>korrigiert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>not saved yet</source>
        <translation>noch nicht gespeichert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>correction</source>
        <translation>Korrektur</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>open</source>
        <translation>offen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>signed off</source>
        <translation>abgeschlossen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>NOT CONNECTED</source>
        <translation>NICHT VERBUNDEN</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>CONNECTED</source>
        <translation>VERBUNDEN</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>RUNNING</source>
        <translation>LÄUFT</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>ENDED</source>
        <translation>BEENDET</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>stopped</source>
        <translation>gestoppt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>completed</source>
        <translation>vollständig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>all goals timed out</source>
        <translation>Zeit aller Ziele abgelaufen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>timeout</source>
        <translation>Zeit abgelaufen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>no data saved</source>
        <translation>keine Daten gespeichert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>module failed</source>
        <translation>Modul ausgefallen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>round {round}, run {run}</source>
        <translation>Runde {round}, Lauf {run}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>{benchmark}, team {team}, {turn}</source>
        <translation>{benchmark}, Team {team}, {turn}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>running</source>
        <translation>läuft</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>never started</source>
        <translation>nie gestartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>connected</source>
        <translation>verbunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>no name</source>
        <translation>ohne Namen</translation>
    </message>
    <message numerus="yes">
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>({n} not attempted)</source>
        <translation>
            <numerusform>({n} nicht versucht)</numerusform>
            <numerusform>({n} nicht versucht)</numerusform>
        </translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>signed off at {time}</source>
        <translation>abgeschlossen um {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>signed off by {name} at {time}</source>
        <translation>abgeschlossen von {name} um {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>withdrawn by {name} at {time}</source>
        <translation>zurückgenommen von {name} um {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>withdrawn at {time}</source>
        <translation>zurückgenommen um {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>{withdrawn}, a correction</source>
        <translation>{withdrawn}, eine Korrektur</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>just now</source>
        <translation>gerade eben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>{time:.0f} s ago</source>
        <translation>vor {time:.0f} s</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>{time:.0f} min ago</source>
        <translation>vor {time:.0f} min</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>{time:.0f} h ago</source>
        <translation>vor {time:.0f} h</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>OLD: waiting for the core</source>
        <translation>VERALTET: warte auf den Core</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>OLD: nothing heard from the core for {time:.0f} s</source>
        <translation>VERALTET: seit {time:.0f} s nichts vom Core gehört</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>never</source>
        <translation>nie</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Mon</source>
        <translation>Mo</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Tue</source>
        <translation>Di</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Wed</source>
        <translation>Mi</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Thu</source>
        <translation>Do</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Fri</source>
        <translation>Fr</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Sat</source>
        <translation>Sa</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Sun</source>
        <translation>So</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Jan</source>
        <translation>Jan.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Feb</source>
        <translation>Feb.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Mar</source>
        <translation>März</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Apr</source>
        <translation>Apr.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>May</source>
        <translation>Mai</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Jun</source>
        <translation>Juni</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Jul</source>
        <translation>Juli</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Aug</source>
        <translation>Aug.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Sep</source>
        <translation>Sep.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Oct</source>
        <translation>Okt.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Nov</source>
        <translation>Nov.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Dec</source>
        <translation>Dez.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>{day} {month}</source>
        <translation>{day}. {month}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/todo.py"/>
        <source>Enter and confirm the switches that the robot changed (OMF Switches)</source>
        <translation>Geben Sie die vom Roboter geänderten Schalter ein und bestätigen Sie sie (OMF-Schalter)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/todo.py"/>
        <source>The benchmarking module is not running: the run is paused</source>
        <translation>Das Benchmark-Modul läuft nicht: Der Lauf ist pausiert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/todo.py"/>
        <source>The robot is working</source>
        <translation>Der Roboter arbeitet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/todo.py"/>
        <source>Start is possible</source>
        <translation>Start ist möglich</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/todo.py"/>
        <source>Score the run, then disconnect</source>
        <translation>Lauf werten, dann trennen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/todo.py"/>
        <source>Connect is possible</source>
        <translation>Verbinden ist möglich</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/todo.py"/>
        <source>Wait: {reasons}</source>
        <translation>Warten: {reasons}</translation>
    </message>
</context>
</TS>
