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
    <name>QDockWidget</name>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>Closes the dock widget</source>
        <translation>Schließt das Fenster</translation>
    </message>
    <message>
        <source>Float</source>
        <translation>Lösen</translation>
    </message>
    <message>
        <source>Undocks and re-attaches the dock widget</source>
        <translation>Löst das Fenster oder hängt es wieder an</translation>
    </message>
</context>
<context>
    <name>roah_rsbb</name>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>the box serves no web pages: start it with web:=true</source>
        <translation>die Box stellt keine Webseiten bereit: starten Sie sie mit web:=true</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Too many wrong codes from this network: wait a minute, or scan the QR code of a new code</source>
        <translation>Zu viele falsche Codes aus diesem Netz: eine Minute warten, oder den QR-Code eines neuen Codes scannen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This code is wrong, was used, or is older than two minutes: ask for a new one</source>
        <translation>Dieser Code ist falsch, verbraucht oder älter als zwei Minuten: lassen Sie sich einen neuen geben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Too many devices are paired: end some pairings first</source>
        <translation>Zu viele Geräte sind gekoppelt: beenden Sie erst einige Kopplungen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Type your name: it is recorded with everything that you enter</source>
        <translation>Geben Sie Ihren Namen ein: er wird mit allem aufgezeichnet, was Sie eingeben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The name {name} is in use on another device ({device}): type another one. If that is your own earlier pairing, ask an organiser to end it first (Teams)</source>
        <translation>Der Name {name} wird schon auf einem anderen Gerät benutzt ({device}): einen anderen eingeben. Ist das die eigene frühere Kopplung, einen Veranstalter bitten, sie zuerst zu beenden (Teams)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The pairing cannot be saved ({error}): free or repair the disk of log_dir</source>
        <translation>Die Kopplung kann nicht gespeichert werden ({error}): schaffen Sie Platz auf dem Datenträger von log_dir oder reparieren Sie ihn</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Ended, but not saved ({error}): it would be valid again after a restart. Free or repair the disk of log_dir, and try again</source>
        <translation>Beendet, aber nicht gespeichert ({error}): Nach einem Neustart würde die Kopplung wieder gelten. Schaffen Sie Platz auf der Platte von log_dir oder reparieren Sie sie, und versuchen Sie es noch einmal</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This connection is not encrypted: whoever can listen in this network can read and use it. Use a network of the referees only.</source>
        <translation>Diese Verbindung ist nicht verschlüsselt: wer in diesem Netz mithören kann, kann sie lesen und benutzen. Verwenden Sie ein Netz nur für Schiedsrichter.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This device may not do that: it is paired as {role}</source>
        <translation>Dieses Gerät darf das nicht: es ist gekoppelt als {role}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No answer from the box: it may have been done. Check the state</source>
        <translation>Keine Antwort von der Box: vielleicht ist es geschehen. Prüfen Sie den Zustand</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The team cannot object to this result: it needs its code, and the time must not be over</source>
        <translation>Das Team kann gegen dieses Ergebnis keinen Einspruch einlegen: es braucht seinen Code, und die Zeit darf nicht vorbei sein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This code is wrong</source>
        <translation>Dieser Code ist falsch</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Too many wrong codes: wait a minute, then try again</source>
        <translation>Zu viele falsche Codes: Warten Sie eine Minute und versuchen Sie es dann noch einmal</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The codes cannot be saved ({error}): free or repair the disk of log_dir</source>
        <translation>Die Codes können nicht gespeichert werden ({error}): Schaffen Sie Platz auf dem Datenträger von log_dir oder reparieren Sie ihn</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This display is not connected</source>
        <translation>Diese Anzeige ist nicht verbunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Too many displays are set: take some back first</source>
        <translation>Für zu viele Anzeigen ist etwas eingestellt: Nehmen Sie zuerst einige Einstellungen zurück</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The setting cannot be saved ({error}): free or repair the disk of log_dir</source>
        <translation>Die Einstellung kann nicht gespeichert werden ({error}): Schaffen Sie Platz auf dem Datenträger von log_dir oder reparieren Sie ihn</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Esc twice</source>
        <translation>Esc zweimal</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>stop the run of the zone, wherever the focus is</source>
        <translation>den Lauf der Zone stoppen, wo auch immer der Fokus ist</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Shift+Esc twice</source>
        <translation>Umschalt+Esc zweimal</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>stop the runs of all zones</source>
        <translation>die Läufe aller Zonen stoppen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>1 to 9</source>
        <translation>1 bis 9</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>score the item with this number: count one more, or yes</source>
        <translation>das Kriterium mit dieser Nummer werten: eins mehr oder ja</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Shift+1 to 9</source>
        <translation>Umschalt+1 bis 9</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>take it back: count one less, or no</source>
        <translation>zurücknehmen: eins weniger oder nein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>open or close this list</source>
        <translation>diese Liste öffnen oder schließen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>{role} in {zone}</source>
        <translation>{role} in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>{role}, all zones</source>
        <translation>{role}, alle Zonen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Whole box</source>
        <translation>Ganze Box</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Zone</source>
        <translation>Zone</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Now</source>
        <translation>Jetzt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Schedule</source>
        <translation>Zeitplan</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Teams</source>
        <translation>Teams</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Home devices</source>
        <translation>Geräte der Wohnung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Results</source>
        <translation>Ergebnisse</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Log</source>
        <translation>Protokoll</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Box</source>
        <translation>Box</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Pairing</source>
        <translation>Koppeln</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Team</source>
        <translation>Team</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>All teams</source>
        <translation>Alle Teams</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Day</source>
        <translation>Tag</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>All days</source>
        <translation>Alle Tage</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>All events</source>
        <translation>Alle Termine</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No event fits these filters.</source>
        <translation>Kein Termin passt zu diesen Filtern.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Choose this event</source>
        <translation>Diesen Termin wählen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>{run} is not signed off. Its score sheet stays in Results.</source>
        <translation>{run} ist nicht abgeschlossen. Der Wertungsbogen bleibt in den Ergebnissen.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>{number} more are not shown</source>
        <translation>{number} weitere sind nicht gezeigt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Each robot is listed here from its first message, with its link and its clock.</source>
        <translation>Jeder Roboter steht hier ab seiner ersten Nachricht, mit Verbindung und Uhr.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This zone has no run yet.</source>
        <translation>Diese Zone hat noch keinen Lauf.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>After Connect, a run is listed here with its score sheet, its history and its sign-off.</source>
        <translation>Nach Verbinden steht ein Lauf hier, mit Wertungsbogen, Verlauf und Abschluss.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No phone of a referee is connected</source>
        <translation>Kein Telefon eines Schiedsrichters ist verbunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No more events</source>
        <translation>Keine weiteren Termine</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Choose or filter</source>
        <translation>Wählen oder filtern</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No event is to come. Events of the schedule are listed here, with their estimated times.</source>
        <translation>Es kommt kein Termin mehr. Termine des Zeitplans stehen hier, mit ihren geschätzten Zeiten.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>To do</source>
        <translation>Zu tun</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Show</source>
        <translation>Zeigen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Nothing waits. Score sheets to sign off, objections and zones without a referee are listed here.</source>
        <translation>Nichts wartet. Wertungsbögen zum Abschließen, Einsprüche und Zonen ohne Schiedsrichter stehen hier.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Standings</source>
        <translation>Ranglisten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No run is signed off yet. Then the teams are ranked here.</source>
        <translation>Noch kein Lauf ist abgeschlossen. Dann steht hier die Rangfolge der Teams.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Compares the files of the competition with what is in force, and asks before anything changes.</source>
        <translation>Vergleicht die Dateien des Wettbewerbs mit dem, was gilt, und fragt, bevor sich etwas ändert.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>History</source>
        <translation>Verlauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Ends</source>
        <translation>Enden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>How the points came about</source>
        <translation>Wie die Punkte zustande kamen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The run is still connected. Disconnect it first.</source>
        <translation>Der Lauf ist noch verbunden. Trennen Sie ihn zuerst.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Text</source>
        <translation>Text</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Search</source>
        <translation>Suchen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>{number} lines</source>
        <translation>{number} Zeilen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Online Data</source>
        <translation>Online-Daten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Nothing has been logged yet</source>
        <translation>Noch nichts protokolliert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No online data from the robot yet</source>
        <translation>Noch keine Online-Daten vom Roboter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Tablet</source>
        <translation>Tablet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The tablet was never heard</source>
        <translation>Vom Tablet wurde noch nichts gehört</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Change the day</source>
        <translation>Den Tag ändern</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>What happens</source>
        <translation>Was passiert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Shift a late zone, swap, move or add events, withdraw a team. The effect is shown before anything changes.</source>
        <translation>Eine verspätete Zone verschieben, Termine tauschen, verlegen oder hinzufügen, ein Team zurückziehen. Die Wirkung wird gezeigt, bevor sich etwas ändert.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Show the effect</source>
        <translation>Wirkung zeigen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Do it</source>
        <translation>Ausführen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This would change:</source>
        <translation>Das würde sich ändern:</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Changes so far</source>
        <translation>Änderungen bisher</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Nothing was changed yet.</source>
        <translation>Noch wurde nichts geändert.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>undone</source>
        <translation>rückgängig gemacht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Reload</source>
        <translation>Neu laden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Apply</source>
        <translation>Übernehmen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Exit</source>
        <translation>Beenden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The box has ended</source>
        <translation>Die Box ist beendet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Start it again on its computer. Runs that were in progress and this page then continue.</source>
        <translation>Starten Sie sie auf ihrem Computer wieder. Laufende Läufe und diese Seite gehen dann weiter.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>May act as</source>
        <translation>Darf handeln als</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>New code</source>
        <translation>Neuer Code</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The code is too old: press New code</source>
        <translation>Der Code ist zu alt: drücken Sie Neuer Code</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Scan the code with the device, or open {page} and type it. It is for one device.</source>
        <translation>Scannen Sie den Code mit dem Gerät, oder öffnen Sie {page} und geben Sie ihn ein. Er gilt für ein Gerät.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Open {page} on the device and type the code. It is for one device.</source>
        <translation>Öffnen Sie {page} auf dem Gerät, und tippen Sie den Code ein. Er gilt für ein Gerät.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Valid for {time}</source>
        <translation>Noch {time} gültig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Paired devices</source>
        <translation>Gekoppelte Geräte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>End pairing</source>
        <translation>Kopplung beenden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Keys</source>
        <translation>Tasten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Pair this device</source>
        <translation>Dieses Gerät koppeln</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>A code comes from an organiser&apos;s page (Whole box, Teams), or from &apos;referee pair&apos; in a terminal. It is valid for two minutes, for one device.</source>
        <translation>Einen Code gibt es auf der Seite eines Veranstalters (Ganze Box, Teams) oder mit &apos;referee pair&apos; im Terminal. Er gilt zwei Minuten, für ein Gerät.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Code</source>
        <translation>Code</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Your name</source>
        <translation>Ihr Name</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This device</source>
        <translation>Dieses Gerät</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Pair</source>
        <translation>Koppeln</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Paired: {role}</source>
        <translation>Gekoppelt: {role}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Without encryption, browsers do not let this page keep the screen on in a run, open without a network or be installed. For that, organisers make a certificate: &apos;new_competition --certificate&apos;</source>
        <translation>Ohne Verschlüsselung erlauben Browser dieser Seite nicht, den Bildschirm im Lauf anzulassen, ohne Netz zu öffnen und installiert zu werden. Dafür erstellen Veranstalter ein Zertifikat: „new_competition --certificate“</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This browser does not trust the certificate of the box, so this page does not open without a network and cannot be installed. Install phones.crt, which the organisers have, then open the page again</source>
        <translation>Dieser Browser vertraut dem Zertifikat der Box nicht. Deshalb öffnet diese Seite nicht ohne Netz und kann nicht installiert werden. Installieren Sie phones.crt, das die Veranstalter haben, und öffnen Sie die Seite dann neu</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>End the pairing of this device</source>
        <translation>Kopplung dieses Geräts beenden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Referee&apos;s page</source>
        <translation>Seite für Schiedsrichter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Our robot</source>
        <translation>Unser Roboter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Code of the team</source>
        <translation>Code des Teams</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Show what the box sees of our robot</source>
        <translation>Zeigen, was die Box von unserem Roboter sieht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Codes of the teams</source>
        <translation>Codes der Teams</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>New codes</source>
        <translation>Neue Codes</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Print</source>
        <translation>Drucken</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Each team sees its link and its clock on its own page with this code.</source>
        <translation>Mit diesem Code sieht jedes Team auf seiner Seite seine Verbindung und seine Uhr.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Everybody sees the links and clocks of all teams (team_pages is all). Codes are not needed.</source>
        <translation>Alle sehen Verbindungen und Uhren aller Teams (team_pages ist all). Codes sind nicht nötig.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Displays</source>
        <translation>Anzeigen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Each /display and /overlay that is open. What you set here counts until you take it back. Its address may give a display its name: /display?name=Hall</source>
        <translation>Jedes geöffnete /display und /overlay. Was Sie hier einstellen, gilt, bis Sie es zurücknehmen. Die Adresse kann einer Anzeige einen Namen geben: /display?name=Halle</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This page is for organisers. Pair this device with the role organiser.</source>
        <translation>Diese Seite ist für Veranstalter. Koppeln Sie dieses Gerät mit der Rolle Veranstalter.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No display is open, and none is set</source>
        <translation>Keine Anzeige ist geöffnet, und für keine ist etwas eingestellt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>not connected</source>
        <translation>nicht verbunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Displays without a place in the list: {number}</source>
        <translation>Anzeigen ohne Platz in der Liste: {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Show the names on all displays</source>
        <translation>Namen auf allen Anzeigen zeigen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Name</source>
        <translation>Name</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Without a name</source>
        <translation>Ohne Namen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Shows</source>
        <translation>Zeigt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Language</source>
        <translation>Sprache</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>as its address says</source>
        <translation>wie in der Adresse</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Take back</source>
        <translation>Zurücknehmen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>since {time}</source>
        <translation>seit {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>{number} windows</source>
        <translation>{number} Fenster</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>all zones</source>
        <translation>alle Zonen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>everything in turns</source>
        <translation>alles im Wechsel</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>the run, explained</source>
        <translation>den Lauf mit Erklärung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>the standings</source>
        <translation>die Rangliste</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>the schedule</source>
        <translation>den Zeitplan</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>the results</source>
        <translation>die Ergebnisse</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>the run, as soon as there is one</source>
        <translation>den Lauf, sobald es einen gibt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>only the clock</source>
        <translation>nur die Uhr</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>the newest result</source>
        <translation>das neueste Ergebnis</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>your own text</source>
        <translation>eigenen Text</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>nothing</source>
        <translation>nichts</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Your own text</source>
        <translation>Eigener Text</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Dr. Ada Byron | Head referee</source>
        <translation>Dr. Ada Byron | Hauptschiedsrichterin</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This device is not paired</source>
        <translation>Dieses Gerät ist nicht gekoppelt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>NO LINK TO THE BOX since {time}. STOP and marks are sent until the box answers</source>
        <translation>KEINE VERBINDUNG ZUR BOX seit {time}. STOPP und Wertungen werden gesendet, bis die Box antwortet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>ANOTHER BOX HAS TAKEN OVER: open the pages at {address}</source>
        <translation>EINE ANDERE BOX HAT ÜBERNOMMEN: Öffnen Sie die Seiten auf {address}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This is the last known state. STOP works, marks wait for the box</source>
        <translation>Das ist der letzte bekannte Zustand. STOPP funktioniert, Wertungen warten auf die Box</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>{zone} is not in the schedule. This page shows {other} now</source>
        <translation>{zone} steht nicht im Zeitplan. Diese Seite zeigt jetzt {other}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>{zone} is not in the schedule. To use this device in another zone, pair it again</source>
        <translation>{zone} steht nicht im Zeitplan. Koppeln Sie dieses Gerät neu, um es in einer anderen Zone zu verwenden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The web gateway cannot show this zone now: see its log. STOP works</source>
        <translation>Das Web-Gateway kann diese Zone gerade nicht zeigen: siehe sein Log. STOPP funktioniert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>A part of this page has failed: {part}. STOP works. Reload the page</source>
        <translation>Ein Teil dieser Seite ist ausgefallen: {part}. STOPP funktioniert. Laden Sie die Seite neu</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Locked, because nobody has touched this page for a while. STOP works</source>
        <translation>Gesperrt, weil diese Seite eine Weile nicht berührt wurde. STOPP funktioniert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Slide to unlock</source>
        <translation>Zum Entsperren schieben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No other zone needs its referee</source>
        <translation>Keine andere Zone braucht ihren Schiedsrichter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Fill in the fields</source>
        <translation>Füllen Sie die Felder aus</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Press again: {command}</source>
        <translation>Noch einmal drücken: {command}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>State</source>
        <translation>Stand</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Commands</source>
        <translation>Befehle</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>More</source>
        <translation>Mehr</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Read on</source>
        <translation>Weiterlesen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Marks: {number}, all sent</source>
        <translation>Eingaben: {number}, alle gesendet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Marks: {number}, {waiting} waiting</source>
        <translation>Eingaben: {number}, davon warten {waiting}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Was it in time?</source>
        <translation>War es rechtzeitig?</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>points</source>
        <translation>Punkte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Timeline</source>
        <translation>Verlauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Add text</source>
        <translation>Text ergänzen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No run yet</source>
        <translation>Noch kein Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Marks may be waiting on the devices of {names}</source>
        <translation>Auf den Geräten von {names} warten vielleicht noch Einträge</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Older entries, in the sheet of the run: {number}</source>
        <translation>Ältere Einträge, im Bogen des Laufs: {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Captain</source>
        <translation>Kapitän</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Read the sheet, then sign with a finger. Whoever refuses says why</source>
        <translation>Lesen Sie den Bogen und unterschreiben Sie mit dem Finger. Wer ablehnt, sagt warum</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Comment</source>
        <translation>Kommentar</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Sign</source>
        <translation>Unterschreiben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Refuse to sign</source>
        <translation>Unterschrift ablehnen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Clear</source>
        <translation>Löschen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Our score sheets</source>
        <translation>Unsere Wertungsbögen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Runs that are over are listed here, for the captain to read and sign.</source>
        <translation>Hier stehen beendete Läufe, die der Kapitän liest und unterschreibt.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Made before the sign-off, arrived after it. Who accepts one signs the new sheet</source>
        <translation>Vor dem Abschluss eingegeben, danach angekommen. Wer annimmt, schließt den neuen Bogen ab</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Accept</source>
        <translation>Annehmen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Drop</source>
        <translation>Verwerfen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Earlier today</source>
        <translation>Heute schon</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>STOP ends the run. It reaches no robot</source>
        <translation>STOP beendet den Lauf. Er erreicht keinen Roboter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>STOP goes to {robot}</source>
        <translation>STOP geht an {robot}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Score sheet</source>
        <translation>Wertungsbogen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Connect {robot}</source>
        <translation>{robot} verbinden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>■ STOP</source>
        <translation>■ STOPP</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>■ STOP ALL</source>
        <translation>■ ALLE STOPPEN</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>hold</source>
        <translation>halten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No run is in progress, so there is nothing to stop</source>
        <translation>Es läuft kein Lauf, also gibt es nichts zu stoppen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This device is not paired, so it cannot stop a robot. A paired device, the referees&apos; table and the robot&apos;s emergency button can</source>
        <translation>Dieses Gerät ist nicht gekoppelt und kann keinen Roboter anhalten. Das können ein gekoppeltes Gerät, der Tisch der Schiedsrichter und der Not-Aus-Taster des Roboters</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Back does not leave this page while a run is in progress</source>
        <translation>„Zurück“ verlässt diese Seite nicht, solange ein Lauf läuft</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>STOP was refused: {reasons}</source>
        <translation>STOPP wurde abgelehnt: {reasons}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>{zone}: STOP WAS NOT DELIVERED. Stop the robot by hand, or press STOP again</source>
        <translation>{zone}: STOPP NICHT ZUGESTELLT. Halten Sie den Roboter von Hand an, oder drücken Sie STOPP</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Switches that the robot changed</source>
        <translation>Schalter, die der Roboter geändert hat</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Damaged switches</source>
        <translation>Beschädigte Schalter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Confirm</source>
        <translation>Bestätigen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>on</source>
        <translation>an</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>off</source>
        <translation>aus</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Yes</source>
        <translation>Ja</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No</source>
        <translation>Nein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Not attempted</source>
        <translation>Nicht versucht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Note</source>
        <translation>Notiz</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>It goes with your next mark of this item</source>
        <translation>Sie gehört zu Ihrer nächsten Eingabe bei diesem Punkt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Set</source>
        <translation>Setzen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Value of {item}</source>
        <translation>Wert von {item}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>{item}: one more</source>
        <translation>{item}: einer mehr</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>{item}: one less</source>
        <translation>{item}: einer weniger</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>More for {item}</source>
        <translation>Mehr zu {item}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>sending {mark}</source>
        <translation>sende {mark}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>NOT CONFIRMED: {mark}. It is sent again until the box answers</source>
        <translation>NICHT BESTÄTIGT: {mark}. Wird wieder gesendet, bis die Box antwortet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>{number} waiting</source>
        <translation>{number} warten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>This browser keeps nothing: leave the page open until the box has it</source>
        <translation>Dieser Browser speichert nichts: die Seite offen lassen, bis die Box alles hat</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>NOT CONFIRMED: {mark}. The box has it, but it is not on all disks yet</source>
        <translation>NICHT BESTÄTIGT: {mark}. Die Box hat die Eingabe, aber sie ist noch nicht auf allen Festplatten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Refused: {what}: {reasons}</source>
        <translation>Abgelehnt: {what}: {reasons}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Undo: {mark}</source>
        <translation>Rückgängig: {mark}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Undo</source>
        <translation>Rückgängig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Put the run right</source>
        <translation>Den Lauf richtigstellen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Event</source>
        <translation>Termin</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Save</source>
        <translation>Speichern</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Saved</source>
        <translation>Gespeichert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Score sheets to sign off</source>
        <translation>Wertungsbögen zum Abschließen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Sign off</source>
        <translation>Wertung abschließen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Correct</source>
        <translation>Korrigieren</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Ratings of {judge}</source>
        <translation>Bewertungen von {judge}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No rating is asked of {judge} now</source>
        <translation>Von {judge} wird jetzt keine Bewertung gebraucht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Your score sheet</source>
        <translation>Ihr Wertungsbogen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Judges</source>
        <translation>Jury</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Submit the sheet</source>
        <translation>Bogen abgeben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Your sheet is submitted and locked. The head referee can hand it back.</source>
        <translation>Ihr Bogen ist abgegeben und gesperrt. Der Hauptschiedsrichter kann ihn zurückgeben.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The box has not confirmed all marks yet</source>
        <translation>Die Box hat noch nicht alle Wertungen bestätigt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The head referee asks you to look again: {reason}</source>
        <translation>Der Hauptschiedsrichter bittet Sie, noch einmal zu prüfen: {reason}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Reason</source>
        <translation>Grund</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Sheets of the judges</source>
        <translation>Bögen der Jury</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Several judges score this run, each on a sheet of their own</source>
        <translation>Mehrere Jurymitglieder werten diesen Lauf, jeder auf einem eigenen Bogen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Provisional result and objections</source>
        <translation>Vorläufiges Ergebnis und Einsprüche</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Who objects</source>
        <translation>Wer Einspruch einlegt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Time of the run, such as 2:41</source>
        <translation>Zeit des Laufs, etwa 2:41</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Replay</source>
        <translation>Wiedergabe</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Objections</source>
        <translation>Einsprüche</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Run</source>
        <translation>Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>No answer from the box: check the network, and try again</source>
        <translation>Keine Antwort von der Box: prüfen Sie das Netz und versuchen Sie es noch einmal</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>▶ Start again</source>
        <translation>▶ Wieder starten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Demonstration</source>
        <translation>Vorführung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Run a competition</source>
        <translation>Einen Wettbewerb durchführen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>New competition</source>
        <translation>Neuer Wettbewerb</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Check a robot</source>
        <translation>Einen Roboter prüfen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>A box with a dummy robot on this computer alone. The organiser&apos;s page opens.</source>
        <translation>Eine Box mit einem simulierten Roboter, nur auf diesem Computer. Die Seite des Veranstalters öffnet sich.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>The box of a competition. The organiser&apos;s page opens. Runs continue where they were.</source>
        <translation>Die Box eines Wettbewerbs. Die Seite des Veranstalters öffnet sich. Läufe gehen dort weiter, wo sie waren.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Creates the folder of a competition: benchmarks, schedule, a password for each team.</source>
        <translation>Legt den Ordner eines Wettbewerbs an: Benchmarks, Zeitplan, ein Passwort für jedes Team.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Plays the box against a robot and reports what works. The robot moves: keep the emergency stop at hand.</source>
        <translation>Spielt die Box für einen Roboter und berichtet, was funktioniert. Der Roboter bewegt sich: Not-Aus bereithalten.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Start the demonstration</source>
        <translation>Vorführung starten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Start the box</source>
        <translation>Box starten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Create it</source>
        <translation>Anlegen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Check it</source>
        <translation>Prüfen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Broadcast address of the robots&apos; network</source>
        <translation>Broadcast-Adresse des Netzes der Roboter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Address of the home devices&apos; controller (empty: they are off)</source>
        <translation>Adresse der Steuerung für die Geräte der Wohnung (leer: sie sind aus)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Competition</source>
        <translation>Wettbewerb</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Name of the competition</source>
        <translation>Name des Wettbewerbs</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Rulebook</source>
        <translation>Regelwerk</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Teams, separated by commas</source>
        <translation>Teams, durch Kommas getrennt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Days</source>
        <translation>Tage</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Arenas, where the rulebook asks</source>
        <translation>Arenen, wo das Regelwerk danach fragt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>How often each team does each benchmark</source>
        <translation>Wie oft jedes Team jeden Benchmark macht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Choices that the rules leave to people, separated by &apos;;&apos;</source>
        <translation>Was die Regeln Menschen überlassen, durch &apos;;&apos; getrennt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Team, as the robot sends it</source>
        <translation>Team, wie der Roboter es sendet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>Password of the team</source>
        <translation>Passwort des Teams</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>in progress</source>
        <translation>läuft</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>done</source>
        <translation>fertig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>ended with status {status}</source>
        <translation>endete mit Status {status}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>End it</source>
        <translation>Beenden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/device.py"/>
        <source>optional</source>
        <translation>optional</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>is judging</source>
        <translation>wertet noch</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>has submitted</source>
        <translation>hat abgegeben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>looks again</source>
        <translation>prüft noch einmal</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>Sheets that are missing: {missing} of {count}</source>
        <translation>Fehlende Bögen: {missing} von {count}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>Missing judges are not waited for: {reason}</source>
        <translation>Auf fehlende Jurymitglieder wird nicht gewartet: {reason}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>The judges differ. Items to settle: {number}</source>
        <translation>Die Jury ist uneins. Zu entscheiden: {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>differs</source>
        <translation>uneins</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>Settled by {name}: {reason}</source>
        <translation>Entschieden von {name}: {reason}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>provisional</source>
        <translation>vorläufig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>objections until {time}</source>
        <translation>Einsprüche bis {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>the time for objections is over</source>
        <translation>die Einspruchsfrist ist vorbei</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>objections to answer: {number}</source>
        <translation>offene Einsprüche: {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>not answered yet</source>
        <translation>noch nicht beantwortet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>upheld</source>
        <translation>stattgegeben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>rejected</source>
        <translation>abgelehnt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>The run is still connected</source>
        <translation>Der Lauf ist noch verbunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>The values are shown when all judges have submitted, or when you do not wait for the others.</source>
        <translation>Die Werte erscheinen, wenn alle Jurymitglieder abgegeben haben oder wenn Sie auf die anderen nicht warten.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>The referee scores this benchmark: see Results.</source>
        <translation>Diesen Benchmark bewertet der Schiedsrichter: siehe Ergebnisse.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>No judge has submitted</source>
        <translation>Kein Jurymitglied hat abgegeben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>No judge has a sheet</source>
        <translation>Kein Jurymitglied hat einen Bogen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>No judge is waited for</source>
        <translation>Auf kein Jurymitglied wird gewartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>The result is not published yet</source>
        <translation>Das Ergebnis ist noch nicht veröffentlicht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>Uphold the objection</source>
        <translation>Dem Einspruch stattgeben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>Reject the objection</source>
        <translation>Den Einspruch ablehnen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>As the benchmarks file says</source>
        <translation>Wie in der Benchmark-Datei</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>None</source>
        <translation>Keine</translation>
    </message>
    <message numerus="yes">
        <location filename="../../src/roah_rsbb/wording/judging.py"/>
        <source>{n} minutes</source>
        <translation>
            <numerusform>{n} Minute</numerusform>
            <numerusform>{n} Minuten</numerusform>
        </translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/language.py"/>
        <source>{whole}.{decimals}</source>
        <translation>{whole},{decimals}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Waiting for the referee box</source>
        <translation>Warte auf die Referee-Box</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The box does not answer yet. This page continues by itself.</source>
        <translation>Die Box antwortet noch nicht. Diese Seite macht von selbst weiter.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>This page needs JavaScript: allow it in the browser&apos;s settings.</source>
        <translation>Diese Seite braucht JavaScript: in den Einstellungen des Browsers erlauben.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>There is no such page</source>
        <translation>Diese Seite gibt es nicht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>All pages of this box</source>
        <translation>Alle Seiten dieser Box</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Nothing is running at the moment</source>
        <translation>Im Moment läuft nichts</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The schedule is done</source>
        <translation>Der Zeitplan ist abgearbeitet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>No signal since {time}: this is the last known state</source>
        <translation>Kein Signal seit {time}: Dies ist der letzte bekannte Zustand</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Runs</source>
        <translation>Läufe</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Next</source>
        <translation>Als Nächstes</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Provisional results</source>
        <translation>Vorläufige Ergebnisse</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Monday</source>
        <translation>Montag</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Tuesday</source>
        <translation>Dienstag</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Wednesday</source>
        <translation>Mittwoch</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Thursday</source>
        <translation>Donnerstag</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Friday</source>
        <translation>Freitag</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Saturday</source>
        <translation>Samstag</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Sunday</source>
        <translation>Sonntag</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>January</source>
        <translation>Januar</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>February</source>
        <translation>Februar</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>March</source>
        <translation>März</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>April</source>
        <translation>April</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>May</source>
        <translation>Mai</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>June</source>
        <translation>Juni</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>July</source>
        <translation>Juli</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>August</source>
        <translation>August</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>September</source>
        <translation>September</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>October</source>
        <translation>Oktober</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>November</source>
        <translation>November</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>December</source>
        <translation>Dezember</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Standing: {benchmark}</source>
        <translation>Rangliste: {benchmark}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Public display</source>
        <translation>Öffentliche Anzeige</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Overlay for video</source>
        <translation>Einblendung für Video</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Data for programs</source>
        <translation>Daten für Programme</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>No results are public yet</source>
        <translation>Noch keine Ergebnisse veröffentlicht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>No standings are public yet</source>
        <translation>Noch keine Rangliste ist öffentlich</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>What each display shows</source>
        <translation>Was jede Anzeige zeigt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>All {number} events</source>
        <translation>Alle {number} Termine</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Nothing is known of this team</source>
        <translation>Über dieses Team ist nichts bekannt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>{time} instead of {planned}</source>
        <translation>{time} statt {planned}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Points</source>
        <translation>Punkte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Rank</source>
        <translation>Rang</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Rank {rank}</source>
        <translation>Rang {rank}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Each zone will have a line here with its team, its state and its clock.</source>
        <translation>Jede Zone bekommt hier eine Zeile mit Team, Zustand und Uhr.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The teams will be listed here as soon as the box has a schedule.</source>
        <translation>Hier stehen die Teams, sobald die Box einen Zeitplan hat.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Watch</source>
        <translation>Zuschauen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Clocks, results and standings as they happen.</source>
        <translation>Uhren, Ergebnisse und Ranglisten, während sie entstehen.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Runs in progress: {number}</source>
        <translation>Laufende Läufe: {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Referee</source>
        <translation>Schiedsrichter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Start and stop runs, mark the score sheet, sign it off.</source>
        <translation>Läufe starten und stoppen, den Wertungsbogen ausfüllen und abzeichnen.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Needs a code of the organiser</source>
        <translation>Braucht einen Code des Veranstalters</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>See your robot&apos;s link, your times and your results.</source>
        <translation>Verbindung des eigenen Roboters, Zeiten und Ergebnisse.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Teams: {number}</source>
        <translation>Teams: {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Organise</source>
        <translation>Veranstalten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Schedule, zones, results, devices and displays.</source>
        <translation>Zeitplan, Zonen, Ergebnisse, Geräte und Anzeigen.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Events to come: {number}</source>
        <translation>Kommende Läufe: {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>More pages</source>
        <translation>Weitere Seiten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>ready</source>
        <translation>bereit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>running</source>
        <translation>läuft</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>ended</source>
        <translation>beendet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>For the team</source>
        <translation>Für das Team</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>{weekday}, {day} {month} {year}</source>
        <translation>{weekday}, {day}. {month} {year}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The robot prepares</source>
        <translation>Der Roboter bereitet sich vor</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The robot carries out its task</source>
        <translation>Der Roboter führt seine Aufgabe aus</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The referee is at work</source>
        <translation>Die Schiedsrichter sind bei der Arbeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The robot carries out the goal</source>
        <translation>Der Roboter führt das Ziel aus</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The robot drives to the waypoint</source>
        <translation>Der Roboter fährt zum Wegpunkt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Robot: {words}</source>
        <translation>Roboter: {words}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Event: {words}</source>
        <translation>Ereignis: {words}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Visitor: {words}</source>
        <translation>Besuch: {words}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Command: {words}</source>
        <translation>Befehl: {words}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The robot drives to waypoint {number}</source>
        <translation>Der Roboter fährt zu Wegpunkt {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The robot carries out goal {number}</source>
        <translation>Der Roboter führt Ziel {number} aus</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>All robots carry out the task at the same time</source>
        <translation>Alle Roboter führen die Aufgabe gleichzeitig aus</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The robot waits for the start</source>
        <translation>Der Roboter wartet auf den Start</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The next goal follows</source>
        <translation>Das nächste Ziel folgt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The referee starts and stops the clock</source>
        <translation>Die Schiedsrichter starten und stoppen die Uhr</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The run is over</source>
        <translation>Der Lauf ist zu Ende</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Waypoints done: {number}</source>
        <translation>Erledigte Wegpunkte: {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Goals done: {number}</source>
        <translation>Erledigte Ziele: {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Waypoints reached: {number} of {all}</source>
        <translation>Erreichte Wegpunkte: {number} von {all}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Goals completed: {number} of {all}</source>
        <translation>Erreichte Ziele: {number} von {all}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The box does not hear the robot</source>
        <translation>Die Box hört den Roboter nicht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Next event: {benchmark} in zone {zone}, about {time}</source>
        <translation>Nächster Termin: {benchmark} in Zone {zone}, etwa um {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>The box hears {robot}, last {seconds} s ago</source>
        <translation>Die Box hört {robot}, zuletzt vor {seconds} s</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Its clock is {seconds} s ahead of the box</source>
        <translation>Seine Uhr geht gegenüber der Box {seconds} s vor</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>Its clock is {seconds} s behind the box</source>
        <translation>Seine Uhr geht gegenüber der Box {seconds} s nach</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>In zone {zone}, connect is off: {reasons}</source>
        <translation>In Zone {zone} ist das Verbinden nicht möglich: {reasons}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>In zone {zone}, the robot can be connected now</source>
        <translation>In Zone {zone} kann der Roboter jetzt verbunden werden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>In zone {zone}, the robot is connected. No message of it has come yet</source>
        <translation>In Zone {zone} ist der Roboter verbunden. Noch ist keine Nachricht von ihm gekommen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>In zone {zone}, the robot is connected. Its state: {state}. Last message {seconds} s ago</source>
        <translation>In Zone {zone} ist der Roboter verbunden. Sein Zustand: {state}. Letzte Nachricht vor {seconds} s</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/public.py"/>
        <source>less than 2</source>
        <translation>weniger als 2</translation>
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
        <source>Begins</source>
        <translation>Beginn</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>Planned</source>
        <translation>Geplant</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/schedule.py"/>
        <source>Benchmark</source>
        <translation>Benchmark</translation>
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
        <source>in time</source>
        <translation>rechtzeitig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>by an incident</source>
        <translation>durch Vorfall</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>After the time limit: it does not count</source>
        <translation>Nach dem Zeitlimit: zählt nicht</translation>
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
        <source>no-show</source>
        <translation>nicht erschienen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>withdrawn</source>
        <translation>zurückgezogen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>The box was away for {time} s of the run</source>
        <translation>Die Box war {time} s des Laufs lang weg</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>The box was away for {time} s of goal {goal}</source>
        <translation>Die Box war {time} s von Ziel {goal} lang weg</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>{points} points</source>
        <translation>{points} Punkte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>{points} points, and {more} for the team</source>
        <translation>{points} Punkte, und {more} für das Team</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Incidents</source>
        <translation>Vorfälle</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Time left</source>
        <translation>Restzeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>{text}. The robot was done meanwhile, so {left_out} s are not counted: the true time is up to {left_out} s longer. Check it</source>
        <translation>{text}. Der Roboter wurde währenddessen fertig, daher zählen {left_out} s nicht: Die wahre Zeit ist bis zu {left_out} s länger. Prüfen Sie sie</translation>
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
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Assistant</source>
        <translation>Assistent</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Judge</source>
        <translation>Jurymitglied</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Timekeeper</source>
        <translation>Zeitnehmer</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Observer</source>
        <translation>Beobachter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Organiser</source>
        <translation>Veranstalter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>{percent} % of the points before</source>
        <translation>{percent} % der Punkte davor</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>of {most}</source>
        <translation>von {most}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>of {points} points</source>
        <translation>von {points} Punkten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>of {most}, {points} points each</source>
        <translation>von {most}, je {points} Punkte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>{points} points each</source>
        <translation>je {points} Punkte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>yes</source>
        <translation>ja</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>no</source>
        <translation>nein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Restart</source>
        <translation>Neustart</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Restarted</source>
        <translation>Neu gestartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Inactive</source>
        <translation>Untätig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Active again</source>
        <translation>Wieder aktiv</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Removed</source>
        <translation>Entfernt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Longer time</source>
        <translation>Mehr Zeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Disqualified</source>
        <translation>Disqualifiziert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Cheating</source>
        <translation>Betrug</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Absent</source>
        <translation>Nicht erschienen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Commands received</source>
        <translation>Befehle erhalten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Extra run</source>
        <translation>Zusatzlauf</translation>
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
        <source>reopened, not signed off again yet</source>
        <translation>wieder geöffnet, noch nicht neu abgeschlossen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>corrected at {time} by {name} (version {number})</source>
        <translation>korrigiert um {time} von {name} (Fassung {number})</translation>
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
        <source>{signed}; replaced at {time} by {name}: what was printed or published in between has it</source>
        <translation>{signed}; ersetzt um {time} von {name}: was dazwischen gedruckt oder veröffentlicht wurde, zeigt diese Fassung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Total</source>
        <translation>Summe</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>{what}: {before}, now {after}</source>
        <translation>{what}: {before}, jetzt {after}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>in time, says {name}</source>
        <translation>rechtzeitig laut {name}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>late, says {name}</source>
        <translation>zu spät laut {name}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>arrived {time} s later</source>
        <translation>{time} s später angekommen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>arrived {time} min later</source>
        <translation>{time} min später angekommen</translation>
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
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>counts</source>
        <translation>zählt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>counts as 0</source>
        <translation>zählt als 0</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>is not over</source>
        <translation>ist nicht beendet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>does not count: never started</source>
        <translation>zählt nicht: nie gestartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>no score: all robots at once</source>
        <translation>keine Wertung: alle Roboter zugleich</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>does not count: annulled</source>
        <translation>zählt nicht: annulliert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>does not count: excluded</source>
        <translation>zählt nicht: ausgenommen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>does not count: not signed off</source>
        <translation>zählt nicht: nicht abgeschlossen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>does not count: a later attempt counts</source>
        <translation>zählt nicht: ein späterer Versuch zählt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>does not count: a better attempt counts</source>
        <translation>zählt nicht: ein besserer Versuch zählt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>does not count: a run of the team at this event counts</source>
        <translation>zählt nicht: ein Lauf des Teams bei diesem Termin zählt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>no score</source>
        <translation>ohne Wertung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/sheets.py"/>
        <source>Whole run</source>
        <translation>Ganzer Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>STOP {zone}: sent …</source>
        <translation>STOPP {zone}: gesendet …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>STOP {zone}: the box has it. Waiting for the robot …</source>
        <translation>STOPP {zone}: Die Box hat ihn. Warten auf den Roboter …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>STOP {zone}: the robot has stopped</source>
        <translation>STOPP {zone}: Der Roboter hat angehalten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>STOP {zone}: the clock is stopped. It reached no robot</source>
        <translation>STOPP {zone}: Die Uhr steht. Er hat keinen Roboter erreicht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>STOP {zone}: NOT DELIVERED. Stop the robot by hand. Trying again …</source>
        <translation>STOPP {zone}: NICHT ZUGESTELLT. Halten Sie den Roboter von Hand an. Neuer Versuch …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>STOP {zone}: NO ANSWER FROM THE ROBOT. Stop it by hand. Trying again …</source>
        <translation>STOPP {zone}: KEINE ANTWORT DES ROBOTERS. Halten Sie ihn von Hand an. Neuer Versuch …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>STOP {zone}: the box has it …</source>
        <translation>STOPP {zone}: Die Box hat ihn …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>sent …</source>
        <translation>gesendet …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>the box has it …</source>
        <translation>Box hat es …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>has stopped</source>
        <translation>steht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>clock stopped</source>
        <translation>Uhr angehalten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>NOT DELIVERED</source>
        <translation>NICHT ZUGESTELLT</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>NO ANSWER</source>
        <translation>KEINE ANTWORT</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>Nothing is running in {zone}. Running: {zones}. Choose one of them, or hold STOP ALL</source>
        <translation>In {zone} läuft nichts. Es laufen: {zones}. Wählen Sie eine davon, oder halten Sie ALLE STOPPEN gedrückt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/stop.py"/>
        <source>{robots} did not answer STOP. After the disconnect the box does not repeat it: stop by hand first</source>
        <translation>{robots}: keine Antwort auf STOPP. Nach dem Trennen wiederholt die Box STOPP nicht: Halten Sie zuerst von Hand an</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/texts.py"/>
        <source>: did you mean &apos;{choice}&apos;?</source>
        <translation>: Meinten Sie „{choice}“?</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/texts.py"/>
        <source>: there is {choices}</source>
        <translation>: Es gibt {choices}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Connected</source>
        <translation>Verbunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Started</source>
        <translation>Gestartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Started again</source>
        <translation>Wieder gestartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Continued</source>
        <translation>Fortgesetzt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Clock paused</source>
        <translation>Uhr angehalten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Clock resumed</source>
        <translation>Uhr läuft weiter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Goal</source>
        <translation>Ziel</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Disconnected</source>
        <translation>Getrennt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Signed off</source>
        <translation>Abgeschlossen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Annulled: it counts nothing</source>
        <translation>Annulliert: zählt nichts</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Score sheet reopened</source>
        <translation>Wertungsbogen wieder geöffnet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>It was made before the sign-off and arrived after it: accept or drop it</source>
        <translation>Vor dem Abschluss eingegeben, danach angekommen: annehmen oder verwerfen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Signed by captain {name} at {time}</source>
        <translation>Von Kapitän {name} um {time} unterschrieben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Captain {name} refused to sign at {time}</source>
        <translation>Kapitän {name} lehnte um {time} die Unterschrift ab</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Corrected after captain {name} signed at {time}</source>
        <translation>Korrigiert, nachdem Kapitän {name} um {time} unterschrieben hatte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Corrected after captain {name} refused to sign at {time}</source>
        <translation>Korrigiert, nachdem Kapitän {name} um {time} die Unterschrift abgelehnt hatte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>A moment to remember: no text yet</source>
        <translation>Gemerkter Moment: noch ohne Text</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Objection {number} of {name}: {text}</source>
        <translation>Einspruch {number} von {name}: {text}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Version {number} of the sheet: {text}</source>
        <translation>Fassung {number} des Bogens: {text}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Moved: {before}, now {after}</source>
        <translation>Verschoben: {before}, jetzt {after}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>taken back by {name} at {time}: {reason}</source>
        <translation>zurückgenommen von {name} um {time}: {reason}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>upheld by {name} at {time}: {reason}</source>
        <translation>stattgegeben von {name} um {time}: {reason}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>rejected by {name} at {time}: {reason}</source>
        <translation>abgelehnt von {name} um {time}: {reason}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>team {team}, {turn}</source>
        <translation>Team {team}, {turn}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Phase: {name}</source>
        <translation>Phase: {name}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Clock paused: {why}</source>
        <translation>Uhr angehalten: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>Goal: {text}</source>
        <translation>Ziel: {text}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>text by {name} at {time}</source>
        <translation>Text von {name} um {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/timeline.py"/>
        <source>dropped by {name} at {time}</source>
        <translation>von {name} um {time} verworfen</translation>
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
        <source>OLD: waiting for the box</source>
        <translation>VERALTET: warte auf die Box</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>OLD: nothing heard from the box for {time:.0f} s</source>
        <translation>VERALTET: seit {time:.0f} s nichts von der Box gehört</translation>
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
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>PAUSED</source>
        <translation>PAUSIERT</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Time left after the stop: {time}</source>
        <translation>Restzeit nach dem Stopp: {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Final time of the run</source>
        <translation>Endzeit des Laufs</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Time limit of a goal</source>
        <translation>Zeitlimit eines Ziels</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Time limit of the run</source>
        <translation>Zeitlimit des Laufs</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>no limit</source>
        <translation>kein Limit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Goal: time left</source>
        <translation>Ziel: Restzeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Run: time used</source>
        <translation>Lauf: benötigte Zeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Used: {time} of {limit}</source>
        <translation>Verbraucht: {time} von {limit}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Run: time left</source>
        <translation>Lauf: Restzeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>used</source>
        <translation>verbraucht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>to set up</source>
        <translation>zum Aufbauen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>for the run</source>
        <translation>für den Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>does not count</source>
        <translation>zählt nicht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>left of {limit}</source>
        <translation>übrig von {limit}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Setup: time left</source>
        <translation>Aufbau: Restzeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Setup: over by</source>
        <translation>Aufbau: überzogen um</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>Phase {number} of {count}, {name}</source>
        <translation>Phase {number} von {count}, {name}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>{phase}: time used</source>
        <translation>{phase}: benötigte Zeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>{phase}: time left</source>
        <translation>{phase}: Restzeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/times.py"/>
        <source>{phase}: over by</source>
        <translation>{phase}: überzogen um</translation>
    </message>
    <message numerus="yes">
        <location filename="../../src/roah_rsbb/wording/todo.py"/>
        <source>⚠ {n} more</source>
        <translation>
            <numerusform>⚠ {n} weitere</numerusform>
            <numerusform>⚠ {n} weitere</numerusform>
        </translation>
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
        <source>The run is in progress</source>
        <translation>Der Lauf ist im Gang</translation>
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
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Broadcast to</source>
        <translation>Broadcast an</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>UDP port</source>
        <translation>UDP-Port</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Robots</source>
        <translation>Roboter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Running</source>
        <translation>Läufe</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Last heard</source>
        <translation>Zuletzt gehört</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Display</source>
        <translation>Anzeige</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Last call</source>
        <translation>Letzter Ruf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Position</source>
        <translation>Position</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Position received</source>
        <translation>Position gesetzt</translation>
    </message>
    <message numerus="yes">
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>{number} of {n} zones</source>
        <translation>
            <numerusform>{number} von {n} Zone</numerusform>
            <numerusform>{number} von {n} Zonen</numerusform>
        </translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>⚠ silent</source>
        <translation>⚠ stumm</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>x {x:.2f} m, y {y:.2f} m</source>
        <translation>x {x:.2f} m, y {y:.2f} m</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>none</source>
        <translation>keine</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Map</source>
        <translation>Karte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Call button</source>
        <translation>Ruftaste</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Robot</source>
        <translation>Roboter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Link</source>
        <translation>Verbindung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Clock skew</source>
        <translation>Uhrabweichung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Run in zone</source>
        <translation>Lauf in Zone</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Objections to answer</source>
        <translation>Zu beantwortende Einsprüche</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Marks from before the sign-off to decide on</source>
        <translation>Eingaben von vor dem Abschluss, über die zu entscheiden ist</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Items to settle</source>
        <translation>Zu entscheidende Punkte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Zones without the phone of a referee</source>
        <translation>Zonen ohne Telefon eines Schiedsrichters</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>No robot is heard</source>
        <translation>Kein Roboter ist zu hören</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>▮▮▮ good</source>
        <translation>▮▮▮ gut</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>▮▮▯ gaps</source>
        <translation>▮▮▯ Lücken</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>▮▯▯ poor</source>
        <translation>▮▯▯ schlecht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>▯▯▯ silent</source>
        <translation>▯▯▯ stumm</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Longest silence of the robot in the last {time:.0f} s. It sends every second.</source>
        <translation>Längste Sendepause des Roboters in den letzten {time:.0f} s. Er sendet jede Sekunde.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>The robot&apos;s clock minus the box&apos;s: + is ahead, - is behind</source>
        <translation>Uhr des Roboters minus Uhr der Box: + geht vor, - geht nach</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>ON</source>
        <translation>AN</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Turn off</source>
        <translation>Aus</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Turn on</source>
        <translation>Ein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>closed</source>
        <translation>zu</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>OPEN</source>
        <translation>OFFEN</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Open</source>
        <translation>Öffnen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Dimmer</source>
        <translation>Dimmer</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Blinds</source>
        <translation>Jalousie</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Door</source>
        <translation>Tür</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Bell</source>
        <translation>Klingel</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>♪ Ring</source>
        <translation>♪ Klingeln</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>What you set here takes effect when the controller is connected again.</source>
        <translation>Was Sie hier einstellen, wirkt, sobald die Steuerung wieder verbunden ist.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>this box controls no home devices: start it with devices:=true</source>
        <translation>Diese Box steuert keine Geräte der Wohnung: Starten Sie sie mit devices:=true</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Switch {number}</source>
        <translation>Schalter {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Last ring: {time}</source>
        <translation>Zuletzt geklingelt: {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>♪ RINGS</source>
        <translation>♪ KLINGELT</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Reload configuration</source>
        <translation>Konfiguration neu laden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Nothing was changed. Correct this first:</source>
        <translation>Nichts wurde geändert. Erst ist zu korrigieren:</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Apply these changes? Connected runs keep what they began with.</source>
        <translation>Diese Änderungen übernehmen? Verbundene Läufe behalten, womit sie begonnen haben.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Scored by the changed sheets, these runs that are over would have other points:</source>
        <translation>Nach den geänderten Bögen gewertet hätten diese beendeten Läufe andere Punkte:</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Apply to the runs that are over, too</source>
        <translation>Auch auf die beendeten Läufe anwenden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>The files contain what is in force</source>
        <translation>Die Dateien enthalten, was bereits gilt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>The changes are in force</source>
        <translation>Die Änderungen gelten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>End the whole RSBB?</source>
        <translation>Die ganze RSBB beenden?</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>End the RSBB</source>
        <translation>RSBB beenden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>This ends the box and everything started with it, for all referees.</source>
        <translation>Das beendet die Box und alles, was mit ihr gestartet wurde, für alle Schiedsrichter.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Runs in progress: {runs}</source>
        <translation>Laufende Läufe: {runs}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Runs in progress: {runs}. End the box when they are over, or confirm that it is to end now: they continue when it is started again</source>
        <translation>Laufende Läufe: {runs}. Beenden Sie die Box, wenn sie vorbei sind, oder bestätigen Sie, dass sie jetzt enden soll: Die Läufe gehen weiter, wenn sie wieder gestartet wird</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>No launch file started this box ({error}): end it where it was started, with Ctrl-C</source>
        <translation>Diese Box wurde von keiner Launch-Datei gestartet ({error}): Beenden Sie sie dort, wo sie gestartet wurde, mit Strg+C</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>REPLAY</source>
        <translation>WIEDERGABE</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>REPLAY: not live</source>
        <translation>WIEDERGABE: nicht live</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>This is a replay: commands have no effect</source>
        <translation>Dies ist eine Wiedergabe: Befehle bewirken nichts</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>superseded: not live</source>
        <translation>abgelöst: nicht live</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/wording/whole_box.py"/>
        <source>Another box has taken over: commands have no effect here</source>
        <translation>Eine andere Box hat übernommen: Befehle bewirken hier nichts</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/basic.py"/>
        <source>Not possible now</source>
        <translation>Jetzt nicht möglich</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/calls.py"/>
        <source>no answer: {why} ({error})</source>
        <translation>keine Antwort: {why} ({error})</translation>
    </message>
    <message numerus="yes">
        <location filename="../../src/roah_rsbb/rqt/calls.py"/>
        <source>{what}: not sent, because {n} commands are still waiting for an answer</source>
        <translation>
            <numerusform>{what}: nicht gesendet, weil {n} Befehl noch auf Antwort wartet</numerusform>
            <numerusform>{what}: nicht gesendet, weil {n} Befehle noch auf Antwort warten</numerusform>
        </translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/calls.py"/>
        <source>{what}: no answer within {time:.0f} s: {why}</source>
        <translation>{what}: keine Antwort innerhalb von {time:.0f} s: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/calls.py"/>
        <source>is the box running? Check the state when it is back.</source>
        <translation>Läuft die Box? Prüfen Sie den Zustand, sobald sie wieder da ist.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/keys.py"/>
        <source>F5 twice</source>
        <translation>F5 zweimal</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/keys.py"/>
        <source>start the benchmark of the zone</source>
        <translation>den Benchmark der Zone starten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/keys.py"/>
        <source>Tab, Shift+Tab</source>
        <translation>Tab, Umschalt+Tab</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/keys.py"/>
        <source>go to the next or previous control; a frame shows where you are</source>
        <translation>zum nächsten oder vorigen Bedienelement gehen; ein Rahmen zeigt, wo Sie sind</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/keys.py"/>
        <source>Space</source>
        <translation>Leertaste</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/keys.py"/>
        <source>press the button in the frame</source>
        <translation>die Schaltfläche im Rahmen drücken</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/keys.py"/>
        <source>Ctrl+F, F3, Shift+F3</source>
        <translation>Strg+F, F3, Umschalt+F3</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/keys.py"/>
        <source>in a log: search, next, previous</source>
        <translation>in einem Protokoll: suchen, nächste, vorige Stelle</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/keys.py"/>
        <source>open this page; Esc closes it</source>
        <translation>diese Seite öffnen; Esc schließt sie</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/keys.py"/>
        <source>■ STOP {zones}?  Press {key} again within {time:.0f} s</source>
        <translation>■ {zones} STOPPEN?  Drücken Sie innerhalb von {time:.0f} s noch einmal {key}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/model.py"/>
        <source>Waiting for the box</source>
        <translation>Warte auf die Box</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/node.py"/>
        <source>Nothing controls the home devices: the box is not running, or not with devices:=true</source>
        <translation>Nichts steuert die Geräte der Wohnung: Die Box läuft nicht, oder nicht mit devices:=true</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/actions.py"/>
        <source>{command} in {zone}</source>
        <translation>{command} in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/actions.py"/>
        <source>Choose a robot, score without a robot, no-show</source>
        <translation>Roboter wählen, ohne Roboter werten, nicht angetreten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>Results, history, judges</source>
        <translation>Ergebnisse, Verlauf, Jury</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>Pair phones and tablets</source>
        <translation>Telefone und Tablets koppeln</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>Open in the browser: results, history and judges, the schedule, pairing</source>
        <translation>Im Browser öffnen: Ergebnisse, Verlauf und Jury, Zeitplan, Kopplung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>No browser opens here. Open {page} in one, and type the code {code}</source>
        <translation>Hier öffnet sich kein Browser. {page} in einem öffnen und den Code {code} eintippen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>Results …</source>
        <translation>Ergebnisse …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>Why was the run stopped? Press Enter to save</source>
        <translation>Warum wurde der Lauf gestoppt? Speichern mit Enter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>The box is silent: nothing can be changed now</source>
        <translation>Die Box ist stumm: Jetzt kann nichts geändert werden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>After a stop, type the reason here and press Enter. You can change it until the run is signed off.</source>
        <translation>Geben Sie nach einem Stopp hier den Grund ein und drücken Sie Enter. Sie können ihn ändern, bis der Lauf abgeschlossen ist.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>Final: signed off by {name}</source>
        <translation>Endgültig: abgeschlossen von {name}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>just pressed</source>
        <translation>gerade gedrückt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>{command}?  Press {key} again within {time:.0f} s</source>
        <translation>{command}?  Drücken Sie innerhalb von {time:.0f} s noch einmal {key}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>keys: F5 twice</source>
        <translation>Tasten: zweimal F5</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>This zone is not in the schedule. Choose a zone above.</source>
        <translation>Diese Zone ist nicht im Zeitplan. Wählen Sie oben eine Zone.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>Benchmark Control</source>
        <translation>Benchmark-Steuerung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>All keys (key: ?)</source>
        <translation>Alle Tasten (Taste: ?)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>NO SUCH ZONE</source>
        <translation>ZONE UNBEKANNT</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>NO BOX</source>
        <translation>KEINE BOX</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>scheduled {time}</source>
        <translation>geplant {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>Scheduled: {time}</source>
        <translation>Geplant: {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>The run is over. Start it again?</source>
        <translation>Der Lauf ist vorbei. Wieder starten?</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>The run is in progress. Disconnect?</source>
        <translation>Der Lauf ist im Gange. Trennen?</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>This ends the run of {robot} in zone {zone}, and it cannot be resumed.</source>
        <translation>Das beendet den Lauf von {robot} in Zone {zone}. Er kann nicht fortgesetzt werden.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>The robot has not stopped. Disconnect?</source>
        <translation>Der Roboter hat nicht angehalten. Trennen?</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>The run is over. Disconnect?</source>
        <translation>Der Lauf ist vorbei. Trennen?</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>Not disconnected: another run is in {zone} now</source>
        <translation>Nicht getrennt: In {zone} ist jetzt ein anderer Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>Not done: {zone} is at another event now</source>
        <translation>Nicht ausgeführt: {zone} ist jetzt bei einem anderen Termin</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/benchmark_control.py"/>
        <source>Connect {robot} in {zone}</source>
        <translation>{robot} verbinden in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/devices.py"/>
        <source>Devices</source>
        <translation>Geräte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/devices.py"/>
        <source>Ring the bell</source>
        <translation>Die Klingel läuten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/devices.py"/>
        <source>✘ NO DEVICES</source>
        <translation>✘ KEINE GERÄTE</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>No manual operation now.</source>
        <translation>Zurzeit kein Handeingriff.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>The robot has finished. Enter and confirm the switches that it changed in the panel OMF Switches.</source>
        <translation>Der Roboter ist fertig. Geben Sie im Fenster OMF-Schalter die Schalter ein, die er geändert hat, und bestätigen Sie sie.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>✔ Manual operation complete</source>
        <translation>✔ Handeingriff erledigt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>✔ Complete with this answer</source>
        <translation>✔ Mit dieser Antwort erledigt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>Manual Operation</source>
        <translation>Handeingriff</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>Manual</source>
        <translation>Eingriff</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>Confirm that it is done. The run continues.</source>
        <translation>Bestätigen, dass es erledigt ist. Der Lauf geht weiter.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>Manual operation complete …</source>
        <translation>Handeingriff erledigt …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>Manual operation complete</source>
        <translation>Handeingriff erledigt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>Used in HOMF only, from the robot&apos;s first goal.</source>
        <translation>Nur in HOMF benutzt, ab dem ersten Ziel des Roboters.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>The robot has not finished. Confirm when it has.</source>
        <translation>Der Roboter ist noch nicht fertig. Bestätigen Sie, sobald er es ist.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>OMF Switches</source>
        <translation>OMF-Schalter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>Switches</source>
        <translation>Schalter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>✔ Confirm switches</source>
        <translation>✔ Schalter bestätigen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>Confirm that the entries are correct</source>
        <translation>Bestätigen, dass die Eingaben stimmen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>The robot pressed switch {number}</source>
        <translation>Der Roboter hat Schalter {number} gedrückt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>One fewer damaged switch</source>
        <translation>Ein beschädigter Schalter weniger</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>One more damaged switch</source>
        <translation>Ein beschädigter Schalter mehr</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>No switch is damaged</source>
        <translation>Kein Schalter ist beschädigt</translation>
    </message>
    <message numerus="yes">
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>{n} damaged</source>
        <translation>
            <numerusform>{n} beschädigt</numerusform>
            <numerusform>{n} beschädigt</numerusform>
        </translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/operations.py"/>
        <source>Switches confirmed</source>
        <translation>Schalter bestätigt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/overview.py"/>
        <source>☛ DO NOW: </source>
        <translation>☛ JETZT: </translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/overview.py"/>
        <source>Show {zone} in all panels of this client</source>
        <translation>{zone} in allen Fenstern dieses Clients zeigen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/overview.py"/>
        <source>Overview</source>
        <translation>Übersicht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/overview.py"/>
        <source>All zones</source>
        <translation>Alle Zonen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/overview.py"/>
        <source>▶ RUNNING: {zones}</source>
        <translation>▶ LÄUFT: {zones}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/panel.py"/>
        <source>The box is silent: this is its last known state</source>
        <translation>Die Box ist stumm: Dies ist ihr letzter bekannter Zustand</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/panel.py"/>
        <source>● live</source>
        <translation>● live</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/panel.py"/>
        <source>✘ {what} failed: {error}</source>
        <translation>✘ {what} ist fehlgeschlagen: {error}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/panel.py"/>
        <source>✔ {what}: done</source>
        <translation>✔ {what}: erledigt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/panel.py"/>
        <source>Show this panel now</source>
        <translation>Dieses Fenster jetzt zeigen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/panel.py"/>
        <source>Leave the space to Scoring</source>
        <translation>Den Platz der Wertung überlassen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/run_times.py"/>
        <source>‼ LAST SECONDS ‼ {label}</source>
        <translation>‼ LETZTE SEKUNDEN ‼ {label}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/score_sheet.py"/>
        <source>Value</source>
        <translation>Wert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/score_sheet.py"/>
        <source>{group}, by {name}, entry {number} of the history</source>
        <translation>{group}, von {name}, Eintrag {number} des Verlaufs</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>Scoring begins when a robot is connected.</source>
        <translation>Die Wertung beginnt, sobald ein Roboter verbunden ist.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>This benchmark has nothing for the referee to score.</source>
        <translation>In diesem Benchmark hat der Schiedsrichter nichts zu werten.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>The box is silent: nothing can be scored now</source>
        <translation>Die Box ist stumm: Jetzt kann nichts gewertet werden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>✔ Yes</source>
        <translation>✔ Ja</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>Counts only with: {items}</source>
        <translation>Zählt nur mit: {items}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>With a note …</source>
        <translation>Mit Notiz …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>Not attempted; add a note</source>
        <translation>Nicht versucht; Notiz hinzufügen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>n/a</source>
        <translation>n.v.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>Result of the jury</source>
        <translation>Ergebnis der Jury</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>Enter your name</source>
        <translation>Ihr Name</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>The referee&apos;s name. It is recorded with everything that you do here.</source>
        <translation>Der Name des Schiedsrichters. Er wird bei allem vermerkt, was Sie hier tun.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>Scoring</source>
        <translation>Wertung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>Not saved: {item}. The score sheet of another run is shown now.</source>
        <translation>Nicht gespeichert: {item}. Jetzt wird der Wertungsbogen eines anderen Laufs gezeigt.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/scoring.py"/>
        <source>Score of the benchmarking module</source>
        <translation>Wertung des Benchmark-Moduls</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/texts.py"/>
        <source>Search (Ctrl+F)</source>
        <translation>Suchen (Strg+F)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/texts.py"/>
        <source>Previous match (Shift+F3)</source>
        <translation>Vorige Stelle (Umschalt+F3)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/texts.py"/>
        <source>Next match (F3, Enter)</source>
        <translation>Nächste Stelle (F3, Enter)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/texts.py"/>
        <source>{number} found</source>
        <translation>{number} gefunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/texts.py"/>
        <source>{number} of {all}</source>
        <translation>{number} von {all}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/texts.py"/>
        <source>No match</source>
        <translation>Keine Stelle gefunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/texts.py"/>
        <source>Type the text to search for</source>
        <translation>Geben Sie den gesuchten Text ein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/texts.py"/>
        <source>Follow the end</source>
        <translation>Dem Ende folgen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/texts.py"/>
        <source>Online</source>
        <translation>Online</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/texts.py"/>
        <source>Log Display</source>
        <translation>Protokoll</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>Core Status</source>
        <translation>Core-Status</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>Core</source>
        <translation>Core</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>The whole box</source>
        <translation>Die ganze Box</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>Exit …</source>
        <translation>Beenden …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>End this client or the whole RSBB. You are asked first.</source>
        <translation>Diesen Client oder die ganze RSBB beenden. Vorher wird nachgefragt.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>Reload …</source>
        <translation>Neu laden …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>Take changed configuration files into use. First, all changes are listed.</source>
        <translation>Geänderte Konfigurationsdateien übernehmen. Vorher werden alle Änderungen aufgelistet.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>Reading the configuration files …</source>
        <translation>Konfigurationsdateien werden gelesen …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>Warning: {line}</source>
        <translation>Warnung: {line}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>End this client?</source>
        <translation>Diesen Client beenden?</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>End this client</source>
        <translation>Client beenden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>This ends only this referee&apos;s client. The box and its runs continue.</source>
        <translation>Das beendet nur den Client dieses Schiedsrichters. Die Box und ihre Läufe gehen weiter.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>Tablet Status</source>
        <translation>Tablet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/panels/whole_box.py"/>
        <source>Active Robots</source>
        <translation>Aktive Roboter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_strip.py"/>
        <source>Stop the run at once: the button acts when it is pressed (keys: Esc twice)</source>
        <translation>Den Lauf sofort stoppen: Der Knopf wirkt beim Drücken (Tasten: zweimal Esc)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_strip.py"/>
        <source>Stop the runs of all zones. Hold the button down (keys: Shift+Esc twice).</source>
        <translation>Die Läufe aller Zonen stoppen. Halten Sie den Knopf gedrückt (Tasten: zweimal Umschalt+Esc).</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_strip.py"/>
        <source>To stop all zones, hold the button down until the runs stop</source>
        <translation>Um alle Zonen zu stoppen, halten Sie die Schaltfläche gedrückt, bis die Läufe stoppen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_strip.py"/>
        <source>⚠ {part} has failed and may show old values. STOP works. The log says more</source>
        <translation>⚠ {part} ist ausgefallen und zeigt vielleicht alte Werte. STOPP wirkt. Das Protokoll sagt mehr</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_strip.py"/>
        <source>Esc twice: {zone}</source>
        <translation>Zweimal Esc: {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_strip.py"/>
        <source>{zone} · Esc is off here</source>
        <translation>{zone} · Esc ist aus</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_strip.py"/>
        <source>STOP and Esc stop {zone}, the only run. You see {shown}</source>
        <translation>STOPP und Esc stoppen {zone}, den einzigen Lauf. Sie sehen {shown}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_strip.py"/>
        <source>The window cannot be smaller: STOP would be cut off</source>
        <translation>Das Fenster kann nicht kleiner sein: STOPP wäre abgeschnitten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_strip.py"/>
        <source>… keep holding</source>
        <translation>… weiter halten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_strip.py"/>
        <source>The line beside STOP</source>
        <translation>Die Zeile neben STOPP</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_strip.py"/>
        <source>The line of the other zones</source>
        <translation>Die Zeile der anderen Zonen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_strip.py"/>
        <source>The box is silent. STOP is sent until it answers</source>
        <translation>Die Box schweigt. STOPP wird gesendet, bis sie antwortet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_window.py"/>
        <source>Esc is off: click here first</source>
        <translation>Esc wirkt nicht: erst hier klicken</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_window.py"/>
        <source>Esc is off, because another window is in front. Press this STOP, or click the window of the RSBB</source>
        <translation>Esc wirkt nicht, weil ein anderes Fenster vorn ist. Drücken Sie dieses STOPP, oder klicken Sie auf das Fenster der RSBB</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_window.py"/>
        <source>RSBB: runs in progress</source>
        <translation>RSBB: Läufe im Gang</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_window.py"/>
        <source>RSBB: no run is in progress</source>
        <translation>RSBB: kein Lauf im Gang</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_window.py"/>
        <source>This STOP closes …</source>
        <translation>Dieses STOPP schließt sich …</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_window.py"/>
        <source>Close until another run begins, or the window of the RSBB is in front again</source>
        <translation>Schließen, bis ein weiterer Lauf beginnt oder das Fenster der RSBB wieder vorn ist</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stop_window.py"/>
        <source>It stays: a STOP has not arrived, or a robot did not answer it</source>
        <translation>Es bleibt: Ein STOPP ist nicht angekommen, oder ein Roboter hat nicht darauf geantwortet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stops.py"/>
        <source>No zone is running</source>
        <translation>Keine Zone läuft</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stops.py"/>
        <source>refused</source>
        <translation>abgelehnt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stops.py"/>
        <source>{way}, stop by hand: {zones}</source>
        <translation>{way}, von Hand anhalten: {zones}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/stops.py"/>
        <source>Stop {zones}</source>
        <translation>{zones} stoppen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/windows.py"/>
        <source>RoAH RSBB – referee</source>
        <translation>RoAH RSBB – Schiedsrichter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rqt/windows.py"/>
        <source>&amp;Panels</source>
        <translation>&amp;Fenster</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/bmbox/framework/module.py"/>
        <source>Pose</source>
        <translation>Pose</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/calls.py"/>
        <source>not saved: {why}. It counts, and is saved as soon as the disk can be written: do not enter it again. Free or repair the disk of log_dir</source>
        <translation>nicht gespeichert: {why}. Die Eingabe zählt und wird gespeichert, sobald der Datenträger beschrieben werden kann: Geben Sie sie nicht noch einmal ein. Schaffen Sie Platz auf dem Datenträger von log_dir, oder reparieren Sie ihn</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/calls.py"/>
        <source>not saved: internal error. It counts until the box ends. Report the error in the box&apos;s log</source>
        <translation>nicht gespeichert: interner Fehler. Die Eingabe zählt, bis die Box endet. Melden Sie den Fehler aus dem Log der Box</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/calls.py"/>
        <source>The call has {name}, which is unknown: the values of the fields of an action go into given</source>
        <translation>Der Aufruf hat {name}, was unbekannt ist: Die Werte der Felder einer Aktion gehören in given</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/calls.py"/>
        <source>{name} is not a text of at most {most} characters</source>
        <translation>{name} ist kein Text von höchstens {most} Zeichen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/calls.py"/>
        <source>The values of the fields are not a JSON object, such as {example}</source>
        <translation>Die Werte der Felder sind kein JSON-Objekt wie {example}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/configuration.py"/>
        <source>{path} is a part of the program, and is not written: the edit is kept in log_dir</source>
        <translation>{path} gehört zum Programm und wird nicht geschrieben: Die Änderung wird in log_dir behalten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/configuration.py"/>
        <source>{path} was changed by hand, too. The edit is written there; what else was changed is in force after &apos;reload&apos;</source>
        <translation>{path} wurde auch von Hand geändert. Die Änderung ist dort eingetragen; was sonst geändert wurde, gilt nach &apos;reload&apos;</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/configuration.py"/>
        <source>{path} was changed by hand, and does not fit the edit, which is in force: it is not written. Enter it there, or &apos;reload&apos; takes it back</source>
        <translation>{path} wurde von Hand geändert und passt nicht zur Änderung, die gilt: Sie wird nicht geschrieben. Tragen Sie sie dort ein, sonst nimmt &apos;reload&apos; sie zurück</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/configuration.py"/>
        <source>{path} cannot be written ({error}). The edit is in force, and is written with the next one or at the next start</source>
        <translation>{path} kann nicht geschrieben werden ({error}). Die Änderung gilt und wird mit der nächsten oder beim nächsten Start geschrieben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/day_edits.py"/>
        <source>There is no edit &apos;{action}&apos;{hint}</source>
        <translation>Es gibt keine Änderung &apos;{action}&apos;{hint}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/day_edits.py"/>
        <source>The effect is another one by now: look at it again</source>
        <translation>Die Wirkung ist inzwischen eine andere: Sehen Sie sie noch einmal an</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/day_edits.py"/>
        <source>There is no edit {number} that can be undone</source>
        <translation>Es gibt keine Änderung {number}, die rückgängig gemacht werden kann</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/day_edits.py"/>
        <source>{event}: {time} in zone &apos;{zone}&apos;, the team does not withdraw</source>
        <translation>{event}: {time} in Zone &apos;{zone}&apos;, das Team zieht nicht zurück</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/day_edits.py"/>
        <source>the team did not withdraw</source>
        <translation>das Team hat nicht zurückgezogen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/day_edits.py"/>
        <source>Team {team} has no such event to come</source>
        <translation>Team {team} hat keinen solchen Termin mehr vor sich</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/day_edits.py"/>
        <source>{event}: {time} in zone &apos;{zone}&apos;, the team withdraws</source>
        <translation>{event}: {time} in Zone &apos;{zone}&apos;, das Team zieht zurück</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/day_edits.py"/>
        <source>Team {team} gets a password, in {path}</source>
        <translation>Team {team} bekommt ein Passwort, in {path}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/day_edits.py"/>
        <source>{number} events of stage &apos;{stage}&apos; are still to come: who advances may change</source>
        <translation>{number} Termine der Stufe „{stage}“ stehen noch aus: Wer weiterkommt, kann sich ändern</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/day_edits.py"/>
        <source>{path} is a part of the program, and is not written: make a competition&apos;s folder</source>
        <translation>{path} gehört zum Programm und wird nicht geschrieben: Legen Sie den Ordner eines Wettbewerbs an</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/day_edits.py"/>
        <source>{path} cannot be written: {error}. Make it writable for this user</source>
        <translation>{path} kann nicht geschrieben werden: {error}. Erlauben Sie diesem Benutzer das Schreiben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/game.py"/>
        <source>stopped, not yet recorded</source>
        <translation>gestoppt, noch nicht aufgezeichnet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/game.py"/>
        <source>stopped, not yet recorded: {why}</source>
        <translation>gestoppt, noch nicht aufgezeichnet: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/game.py"/>
        <source>the disk of log_dir takes no data. The robot gets STOP all the same. Check the disk</source>
        <translation>die Festplatte von log_dir nimmt keine Daten an. Der Roboter bekommt STOP trotzdem. Prüfen Sie die Festplatte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/game.py"/>
        <source>the journal cannot be written: {why}. The robot gets STOP all the same. Free or repair the disk of log_dir</source>
        <translation>das Journal kann nicht geschrieben werden: {why}. Der Roboter bekommt STOP trotzdem. Schaffen Sie Platz auf der Festplatte von log_dir, oder reparieren Sie sie</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/game.py"/>
        <source>the standby does not have it, because it is not connected. Write the STOP down, and check the standby</source>
        <translation>der Standby hat es nicht, weil er nicht verbunden ist. Schreiben Sie das STOP auf, und prüfen Sie den Standby</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/offers.py"/>
        <source>No program offers {what} now: start the one that does</source>
        <translation>Kein Programm bietet {what} jetzt an: starten Sie das zuständige</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/offers.py"/>
        <source>its connection ended. It may have been done</source>
        <translation>seine Verbindung ist abgebrochen. Es kann ausgeführt worden sein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/offers.py"/>
        <source>{what}: no answer within {time} s: {why}</source>
        <translation>{what}: keine Antwort innerhalb von {time} s: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/offers.py"/>
        <source>{what}: not sent, because too many calls wait for an answer. Try again in a moment</source>
        <translation>{what}: nicht gesendet, weil zu viele Aufrufe auf Antwort warten. Versuchen Sie es gleich noch einmal</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/offers.py"/>
        <source>{what}: malformed answer from the program that offers it. Install the same version there as on the box</source>
        <translation>{what}: fehlerhafte Antwort des Programms, das es anbietet. Dort dieselbe Version wie auf der Box installieren</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/program/modules_process.py"/>
        <source>its rules do not answer ({place})</source>
        <translation>seine Regeln antworten nicht ({place})</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/box/program/modules_process.py"/>
        <source>its rules end their process ({place})</source>
        <translation>seine Regeln beenden ihren Prozess ({place})</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/modules.py"/>
        <source>zone &apos;{zone}&apos; has no manual operation now</source>
        <translation>Zone „{zone}“ hat jetzt keinen Handeingriff</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/modules.py"/>
        <source>that manual operation is over; the current one is: {text}</source>
        <translation>jener Handeingriff ist vorbei; der aktuelle ist: {text}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/modules.py"/>
        <source>zone &apos;{zone}&apos; runs {code}, which has no switches</source>
        <translation>in Zone „{zone}“ läuft {code}, das keine Schalter hat</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/modules.py"/>
        <source>zone &apos;{zone}&apos; has no switches to enter: they come with a goal for switches</source>
        <translation>Zone „{zone}“ hat keine Schalter zum Eintragen: Sie kommen mit einem Ziel für Schalter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/modules.py"/>
        <source>the switches cannot be confirmed yet: the robot has not finished</source>
        <translation>die Schalter können noch nicht bestätigt werden: Der Roboter ist nicht fertig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>A run is connected: disconnect it first</source>
        <translation>Ein Lauf ist verbunden: Trennen Sie ihn zuerst</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>A run is running: stop it first</source>
        <translation>Ein Lauf läuft: Stoppen Sie ihn zuerst</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>run {run} is running: stop it first</source>
        <translation>Lauf {run} läuft: Stoppen Sie ihn zuerst</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>No run is connected</source>
        <translation>Kein Lauf ist verbunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>{code} is for all robots at once: connect without a robot</source>
        <translation>{code} ist für alle Roboter zugleich: Verbinden Sie, ohne einen Roboter zu nennen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>The run was started, so its team appeared</source>
        <translation>Der Lauf wurde gestartet, das Team ist also erschienen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>This event is signed off: go to the next one, unless another attempt is due</source>
        <translation>Dieser Termin ist abgeschlossen: Gehen Sie zum nächsten, außer wenn ein weiterer Versuch ansteht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>No run is running</source>
        <translation>Es läuft kein Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>Already started</source>
        <translation>Schon gestartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>The rules of this benchmark do not allow a restart: disconnect, and connect for a new run</source>
        <translation>Die Regeln dieses Benchmarks erlauben keinen Neustart: Trennen Sie ihn und verbinden Sie sich für einen neuen Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>The run ended by timeout: disconnect, and connect for a new run</source>
        <translation>Die Zeit des Laufs ist abgelaufen: Trennen Sie ihn und verbinden Sie sich für einen neuen Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>The run&apos;s time is up (the clock kept running after the stop): disconnect, and connect for a new run</source>
        <translation>Die Zeit des Laufs ist um (die Uhr lief nach dem Stopp weiter): Trennen Sie ihn und verbinden Sie sich für einen neuen Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>The run is not started: disconnect to leave it</source>
        <translation>Der Lauf ist nicht gestartet: Verlassen Sie ihn mit Trennen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>The run is over, but the robot did not answer STOP: stop it by hand</source>
        <translation>Der Lauf ist vorbei, aber der Roboter hat nicht auf STOPP geantwortet: Halten Sie ihn von Hand an</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>The run is over: disconnect to leave it</source>
        <translation>Der Lauf ist vorbei: Verlassen Sie ihn mit Trennen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>The rules of this benchmark do not allow a pause</source>
        <translation>Die Regeln dieses Benchmarks erlauben keine Pause</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>The run is not in doubt after a restart</source>
        <translation>Es gibt nach einem Neustart keinen Zweifel an diesem Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>This benchmark has no phases</source>
        <translation>Dieser Benchmark hat keine Phasen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>The event is of team {team} now: choose it again</source>
        <translation>Der Termin ist jetzt von Team {team}: Wählen Sie ihn erneut</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>The clock is paused</source>
        <translation>Die Uhr ist angehalten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>The clock is not paused</source>
        <translation>Die Uhr ist nicht angehalten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>This is the first phase</source>
        <translation>Das ist die erste Phase</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>This is the last phase</source>
        <translation>Das ist die letzte Phase</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>This is the zone&apos;s first event</source>
        <translation>Das ist der erste Termin der Zone</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/runs.py"/>
        <source>This is the zone&apos;s last event</source>
        <translation>Das ist der letzte Termin der Zone</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/table.py"/>
        <source>no action &apos;{action}&apos;{hint}</source>
        <translation>keine Aktion „{action}“{hint}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/table.py"/>
        <source>Name the team: the zone may have gone to the event of another one</source>
        <translation>Nennen Sie das Team: Die Zone kann inzwischen beim Termin eines anderen sein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/table.py"/>
        <source>The current event of zone &apos;{zone}&apos; is of team {team}, not of team {named}: choose the event first</source>
        <translation>Der aktuelle Termin der Zone „{zone}“ ist von Team {team}, nicht von Team {named}: Wählen Sie zuerst den Termin</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/table.py"/>
        <source>Zone &apos;{zone}&apos; is at another event of team {team} now: choose the event first</source>
        <translation>Zone „{zone}“ ist jetzt bei einem anderen Termin von Team {team}: Wählen Sie zuerst den Termin</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/table.py"/>
        <source>run {run} is not connected in zone &apos;{zone}&apos;</source>
        <translation>Lauf {run} ist in Zone „{zone}“ nicht verbunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/actions/table.py"/>
        <source>The item gets no value: give its value, or say that it was not attempted</source>
        <translation>Der Punkt bekommt keinen Wert: Geben Sie seinen Wert an, oder dass er nicht versucht wurde</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/authority.py"/>
        <source>This box is superseded: the box at {address} has taken over. Nothing is sent to robots, and commands are refused. Use the panels of the other box</source>
        <translation>Diese Box ist abgelöst: Die Box auf {address} hat übernommen. An Roboter wird nichts gesendet, und Befehle werden abgelehnt. Benutzen Sie die Fenster der anderen Box</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>All UDP ports up to {port} are used up: start the box with another log_dir, whose record of used ports is empty, and if need be with a lower rsbb_port</source>
        <translation>Alle UDP-Ports bis {port} sind verbraucht: Starten Sie die Box mit einem anderen log_dir, in dem noch keine Ports vermerkt sind, und nötigenfalls mit kleinerem rsbb_port</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>All UDP ports up to {port} but {left} are used up, and {number} robots need one each: start the box with another log_dir, whose record of used ports is empty, and if need be with a lower rsbb_port</source>
        <translation>Alle UDP-Ports bis {port} bis auf {left} sind verbraucht, und {number} Roboter brauchen je einen: Starten Sie die Box mit einem anderen log_dir, in dem noch keine Ports vermerkt sind, und nötigenfalls mit kleinerem rsbb_port</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>The beacon may need {size} bytes with {more}, and robots may read only {most}: {remedies}, or raise max_datagram if all robots are known to read more</source>
        <translation>Der Beacon braucht mit {more} bis zu {size} Byte, und Roboter lesen vielleicht nur {most}: {remedies}, oder erhöhen Sie max_datagram, wenn sicher alle Roboter mehr lesen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>Already connected</source>
        <translation>Schon verbunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>The box is still listening for another box, for {time} s</source>
        <translation>Die Box horcht noch {time} s lang auf eine andere Box</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>The only attempt at this event was made: go to the next event. To allow more, raise &apos;attempts&apos; in benchmarks.yaml</source>
        <translation>Der einzige Versuch dieses Termins ist gemacht: Gehen Sie zum nächsten Termin. Um mehr zu erlauben, erhöhen Sie „attempts“ in benchmarks.yaml</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>The last of {number} attempts at this event was made: go to the next event. To allow more, raise &apos;attempts&apos; in benchmarks.yaml</source>
        <translation>Der letzte von {number} Versuchen dieses Termins ist gemacht: Gehen Sie zum nächsten Termin. Um mehr zu erlauben, erhöhen Sie „attempts“ in benchmarks.yaml</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>No robot &apos;{robot}&apos; of team {team} is ready to connect{hint}</source>
        <translation>Kein Roboter „{robot}“ des Teams {team} ist bereit zum Verbinden{hint}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>No robot of team {team} is active: none of its beacons arrives on UDP port {port}</source>
        <translation>Kein Roboter von Team {team} ist aktiv: Keines seiner Beacons kommt auf UDP-Port {port} an</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>No robot is active: no beacon arrives on UDP port {port}</source>
        <translation>Kein Roboter ist aktiv: Kein Beacon kommt auf UDP-Port {port} an</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>Robot {robot} is in a run in zone {zone}</source>
        <translation>Roboter {robot} ist in einem Lauf in Zone {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>robot {robot}</source>
        <translation>Roboter {robot}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>{robot} cannot take part: {why}</source>
        <translation>{robot} kann nicht teilnehmen: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>it is in a run in zone {zone}</source>
        <translation>er ist in einem Lauf in Zone {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>its team has no password in the passwords file</source>
        <translation>sein Team hat kein Passwort in der Passwortdatei</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>it was not heard for {time} s</source>
        <translation>er wurde seit {time} s nicht gehört</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>{robot} is active, but not in this run: disconnect and connect again to include it</source>
        <translation>{robot} ist aktiv, aber nicht in diesem Lauf: Trennen und verbinden Sie, um ihn aufzunehmen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>one more robot</source>
        <translation>einem weiteren Roboter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>{number} more robots</source>
        <translation>{number} weiteren Robotern</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>leave only {number} of them switched on</source>
        <translation>lassen Sie nur {number} davon eingeschaltet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/connections.py"/>
        <source>end another run first</source>
        <translation>beenden Sie zuerst einen anderen Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/continuing.py"/>
        <source>This is a replay of {run}: nothing here is live, and commands have no effect</source>
        <translation>Dies ist die Wiedergabe von {run}: nichts hier ist live, und Befehle bewirken nichts</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/continuing.py"/>
        <source>The box was restarted at {time}, {down} s after its last record</source>
        <translation>Die Box wurde um {time} neu gestartet, {down} s nach ihrem letzten Eintrag</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/continuing.py"/>
        <source>The run of {benchmark}, team {team}, that was connected before the restart cannot continue: {why}. Its scores are in the journal: the program &apos;results&apos; shows them</source>
        <translation>Der Lauf von {benchmark}, Team {team}, der vor dem Neustart verbunden war, kann nicht weitergehen: {why}. Seine Wertungen sind im Journal: Das Programm &apos;results&apos; zeigt sie</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/continuing.py"/>
        <source>zone &apos;{zone}&apos; is no longer in the schedule</source>
        <translation>Zone „{zone}“ steht nicht mehr im Zeitplan</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/continuing.py"/>
        <source>its event is no longer in the schedule of zone &apos;{zone}&apos;</source>
        <translation>sein Termin steht nicht mehr im Zeitplan der Zone „{zone}“</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/continuing.py"/>
        <source>The schedule was changed while no box ran: the zone goes to {code}, team {team}</source>
        <translation>Der Zeitplan wurde geändert, während keine Box lief: Die Zone geht zu {code}, Team {team}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/continuing.py"/>
        <source>its saved state is invalid ({error})</source>
        <translation>sein gespeicherter Zustand ist ungültig ({error})</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/continuing.py"/>
        <source>zone &apos;{zone}&apos; is no longer in the schedule, but a run of {code} is connected in it: disconnect it first</source>
        <translation>Zone „{zone}“ steht nicht mehr im Zeitplan, aber ein Lauf von {code} ist dort verbunden: Trennen Sie ihn zuerst</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/continuing.py"/>
        <source>to score signed sheets by other rules needs the name of who decided it: enter it, in the terminal with --by</source>
        <translation>abgeschlossene Bögen nach anderen Regeln zu werten braucht den Namen dessen, der es entschieden hat: geben Sie ihn ein, im Terminal mit --by</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/continuing.py"/>
        <source>{text}: the run continues if its robot does</source>
        <translation>{text}: Der Lauf geht weiter, wenn sein Roboter weitermacht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/continuing.py"/>
        <source>{text}: the run continues on the box at {address}</source>
        <translation>{text}: Der Lauf geht auf der Box auf {address} weiter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/copies.py"/>
        <source>not confirmed: {why}. It counts, and is saved on this computer: do not enter it again. It is confirmed as soon as the standby has it</source>
        <translation>nicht bestätigt: {why}. Die Eingabe zählt und ist auf dem Computer der Box gespeichert: Geben Sie sie nicht noch einmal ein. Sie wird bestätigt, sobald der Standby sie hat</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/copies.py"/>
        <source>not confirmed: the box at {address} has taken over, and may not have this entry. Look there, and enter it there if it is missing</source>
        <translation>nicht bestätigt: Die Box auf {address} hat übernommen und hat diese Eingabe vielleicht nicht. Sehen Sie dort nach, und geben Sie sie dort ein, wenn sie fehlt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/copies.py"/>
        <source>NOT CONFIRMED: the standby does not have the last entries: {why}</source>
        <translation>NICHT BESTÄTIGT: Dem Standby fehlen die letzten Einträge: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/copies.py"/>
        <source>{why}. To continue with one computer, delete &apos;durable: two&apos; in {place} and reload</source>
        <translation>{why}. Um mit einem Computer fortzufahren, löschen Sie &apos;durable: two&apos; in {place}, und laden Sie neu</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/copies.py"/>
        <source>the standby did not answer within {time} s</source>
        <translation>der Standby hat nicht innerhalb von {time} s geantwortet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/copies.py"/>
        <source>the program that copies it does not report. See the terminal of the box</source>
        <translation>Das Programm, das es kopiert, meldet sich nicht. Sehen Sie im Terminal der Box nach</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/copies.py"/>
        <source>the journal of this box is not copied yet. If this lasts, the program that copies it has another log_dir: end it, and the box starts it again</source>
        <translation>das Journal dieser Box wird noch nicht kopiert. Wenn das so bleibt, hat das Programm, das es kopiert, ein anderes log_dir: beenden Sie es, und die Box startet es neu</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/copies.py"/>
        <source>the copy is being written. If this lasts, its disk or its connection is too slow</source>
        <translation>Die Kopie wird geschrieben. Wenn das so bleibt, ist ihr Datenträger oder ihre Verbindung zu langsam</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/copies.py"/>
        <source>The copy of the journal ({place}) is {time} s behind: {why}</source>
        <translation>Die Kopie des Journals ({place}) ist {time} s zurück: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/copies.py"/>
        <source>The copy of the journal ({place}) is {time} s, {size} kB behind: {why}</source>
        <translation>Die Kopie des Journals ({place}) ist {time} s, {size} kB zurück: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/day.py"/>
        <source>No stage &apos;{stage}&apos; from which teams advance: standings.yaml has {stages}{hint}</source>
        <translation>Keine Stufe „{stage}“, aus der Teams weiterkommen: standings.yaml hat {stages}{hint}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/day.py"/>
        <source>Nobody has a signed result in stage &apos;{stage}&apos; yet</source>
        <translation>Niemand hat bisher ein abgeschlossenes Ergebnis in der Stufe „{stage}“</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/day.py"/>
        <source>Stage &apos;{stage}&apos; leads to no test that only those run who advance: name one in a stage whose &apos;teams&apos; it is</source>
        <translation>Stufe „{stage}“ führt zu keinem Test, den nur die machen, die weiterkommen: Nennen Sie einen in einer Stufe, deren „teams“ sie ist</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/desks.py"/>
        <source>name the run: what arrives late must not count in another run</source>
        <translation>nennen Sie den Lauf: Was spät ankommt, darf nicht in einem anderen Lauf zählen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/desks.py"/>
        <source>run {run} was in zone &apos;{zone}&apos;, not in &apos;{other}&apos;</source>
        <translation>Lauf {run} war in Zone „{zone}“, nicht in „{other}“</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/desks.py"/>
        <source>the run was scored by the sheet of {code}: it can be moved to an event of {code} of one team. Otherwise annul it, and enter the score at the right event (&apos;Score without a robot&apos;)</source>
        <translation>der Lauf wurde nach dem Bogen von {code} gewertet: er kann zu einem Termin von {code} eines Teams verschoben werden. Sonst annullieren und die Wertung beim richtigen Termin eingeben („Ohne Roboter werten“)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/desks.py"/>
        <source>the event has no id: reload the configuration first, which writes it</source>
        <translation>der Termin hat keine Kennung: erst die Konfiguration neu laden, das schreibt sie</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/desks.py"/>
        <source>the run belongs to this event already</source>
        <translation>der Lauf gehört schon zu diesem Termin</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/desks.py"/>
        <source>the team has had its {number} attempts at that event: annul one of them first</source>
        <translation>das Team hatte seine {number} Versuche bei diesem Termin: erst einen davon annullieren</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/desks.py"/>
        <source>run {run} is still connected: disconnect it first</source>
        <translation>Lauf {run} ist noch verbunden: Trennen Sie ihn zuerst</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/desks.py"/>
        <source>name the run to sign off: only a run that is over can be signed off</source>
        <translation>nennen Sie den Lauf, der abgeschlossen wird: Nur ein beendeter Lauf kann abgeschlossen werden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/desks.py"/>
        <source>the id &apos;{id}&apos; cannot identify a mark: give each mark a new UUID</source>
        <translation>die Kennung „{id}“ kann keine Wertung bezeichnen: Geben Sie jeder Wertung eine neue UUID</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/desks.py"/>
        <source>no role &apos;{role}&apos;: choose one of {choices}</source>
        <translation>keine Rolle „{role}“: Wählen Sie aus {choices}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/desks.py"/>
        <source>run {run} is over, but run {other} is running in zone &apos;{zone}&apos;: stop again</source>
        <translation>Lauf {run} ist vorbei, aber Lauf {other} läuft in Zone „{zone}“: Stoppen Sie noch einmal</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/link.py"/>
        <source>Robot has not answered on the private channel yet</source>
        <translation>Der Roboter hat auf dem privaten Kanal noch nicht geantwortet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/link.py"/>
        <source>No message from the robot for {time} s</source>
        <translation>Seit {time} s keine Nachricht vom Roboter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/link.py"/>
        <source>No message from the robot for {time} s but old ones: its clock was set back or stopped, or somebody sends recordings. Set its clock right, and it is heard again</source>
        <translation>Seit {time} s nur alte Nachrichten vom Roboter: Seine Uhr wurde zurückgestellt oder steht, oder jemand sendet Aufzeichnungen. Stellen Sie seine Uhr richtig, dann wird er wieder gehört</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/link.py"/>
        <source>No message from the robot for {time} s, but its beacons arrive: its program was restarted, or a firewall blocks the private channel. Check whether it moves</source>
        <translation>Seit {time} s keine Nachricht vom Roboter, aber seine Beacons kommen an: Sein Programm wurde neu gestartet, oder eine Firewall sperrt den privaten Kanal. Prüfen Sie, ob er sich bewegt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/link.py"/>
        <source>The robot has disappeared: no message for {time} s, and no beacon from its address. It may still be moving, and STOP may not reach it: check it</source>
        <translation>Der Roboter ist verschwunden: seit {time} s keine Nachricht und kein Beacon von seiner Adresse. Er bewegt sich vielleicht noch, und STOPP erreicht ihn vielleicht nicht: Prüfen Sie ihn</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/link.py"/>
        <source>Robot&apos;s times are INVALID: clock skew {skew}, must be below {limit} s: synchronise the robot&apos;s clock</source>
        <translation>Die Zeiten des Roboters sind UNGÜLTIG: Seine Uhr weicht um {skew} ab, erlaubt sind weniger als {limit} s: Stellen Sie die Uhr des Roboters</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/link.py"/>
        <source>Messages for this run also come from {host}. They are ignored: the robot is at {address}. Give the other robot another robot_name, or switch it off</source>
        <translation>Nachrichten für diesen Lauf kommen auch von {host}. Sie zählen nicht: Der Roboter ist auf {address}. Geben Sie dem anderen Roboter einen anderen robot_name, oder schalten Sie ihn aus</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/link.py"/>
        <source>Robot&apos;s address changed from {before} to {host}</source>
        <translation>Die Adresse des Roboters wechselte von {before} zu {host}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/link.py"/>
        <source>Robot&apos;s clock was set back</source>
        <translation>Die Uhr des Roboters wurde zurückgestellt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/link.py"/>
        <source>Robot&apos;s clock was set back by {time} s</source>
        <translation>Die Uhr des Roboters wurde um {time} s zurückgestellt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/link.py"/>
        <source>Robot&apos;s clock jumped forward by {time} s</source>
        <translation>Die Uhr des Roboters sprang um {time} s vor</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/link.py"/>
        <source>Robot has not stopped yet: it reports {state}</source>
        <translation>Der Roboter hat noch nicht gestoppt: Er meldet {state}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/skew.py"/>
        <source>the robot</source>
        <translation>dem Roboter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/skew.py"/>
        <source>Clock skew of {robot} is not known yet</source>
        <translation>Die Uhrabweichung von {robot} ist noch nicht bekannt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/link/skew.py"/>
        <source>Clock skew of {robot} is {skew}, but must be below {limit} s: synchronise the robot&apos;s clock</source>
        <translation>Die Uhr von {robot} weicht um {skew} ab, erlaubt sind weniger als {limit} s: Stellen Sie die Uhr des Roboters</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/modules.py"/>
        <source>Benchmarking module not connected: nothing drives {code}. Start the box with modules:=true, and see its log: the rules may be damaged</source>
        <translation>Das Benchmark-Modul ist nicht verbunden: Nichts führt {code}. Starten Sie die Box mit modules:=true, und sehen Sie in ihrem Protokoll nach: Die Regeln können beschädigt sein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/modules.py"/>
        <source>there is no switch {switch}: they are numbered 1 to {count}</source>
        <translation>es gibt keinen Schalter {switch}: Sie sind von 1 bis {count} nummeriert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/modules.py"/>
        <source>no more than {most} changes of switches can be entered</source>
        <translation>mehr als {most} Änderungen von Schaltern können nicht eingetragen werden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/robots.py"/>
        <source>{robot} of team {team}</source>
        <translation>{robot} von Team {team}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/robots.py"/>
        <source>The box cannot reach {robot} at {host}: it has no route to this network. Give the robot an address in the box&apos;s network</source>
        <translation>Die Box erreicht {robot} auf {host} nicht: Sie hat keine Route in dieses Netz. Dem Roboter eine Adresse im Netz der Box geben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>{robot}: {text}</source>
        <translation>{robot}: {text}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>{doing}, messages saved: {number}</source>
        <translation>{doing}, gespeicherte Nachrichten: {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>Started with {number} of {all} robots</source>
        <translation>Gestartet mit {number} von {all} Robotern</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>Robots connected: {number} / ready: {ready}</source>
        <translation>Roboter verbunden: {number} / bereit: {ready}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>Robots preparing: {preparing} / executing: {executing} / stopped: {stopped}</source>
        <translation>Roboter in Vorbereitung: {preparing} / in Ausführung: {executing} / gestoppt: {stopped}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>left out until it is ready: {why}</source>
        <translation>ausgelassen, bis er bereit ist: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>will be left out until it is ready: {why}</source>
        <translation>wird ausgelassen, bis er bereit ist: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>not ready: {why}</source>
        <translation>nicht bereit: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>{number} {end}</source>
        <translation>{number} {end}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>{end} ({counted})</source>
        <translation>{end} ({counted})</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>stopped by the referee</source>
        <translation>vom Schiedsrichter gestoppt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>out of time</source>
        <translation>Zeit abgelaufen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>saved no offline data</source>
        <translation>ohne gespeicherte Offline-Daten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>All robots have ended</source>
        <translation>Alle Roboter sind fertig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>Stopped: no robot saves offline data</source>
        <translation>Gestoppt: Kein Roboter speichert Offline-Daten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>preparing</source>
        <translation>bereitet sich vor</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/all_robots.py"/>
        <source>executing</source>
        <translation>führt aus</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/by_hand.py"/>
        <source>Without a robot: only the referee starts and stops the clock</source>
        <translation>Ohne Roboter: Nur der Schiedsrichter startet und stoppt die Uhr</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/by_hand.py"/>
        <source>Score sheet opened without a robot</source>
        <translation>Wertungsbogen ohne Roboter geöffnet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/by_hand.py"/>
        <source>Started by the referee</source>
        <translation>Vom Schiedsrichter gestartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Started: the benchmarking module begins</source>
        <translation>Gestartet: Das Benchmark-Modul beginnt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Requested the robot to prepare for a new goal</source>
        <translation>Der Roboter soll sich auf ein neues Ziel vorbereiten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Robot prepared, goal sent</source>
        <translation>Der Roboter ist vorbereitet, das Ziel ist gesendet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Robot received the goal, waiting for its result</source>
        <translation>Der Roboter hat das Ziel, warte auf sein Ergebnis</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Benchmark complete</source>
        <translation>Der Benchmark ist vollständig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Benchmark complete: {late} of {number} goals timed out</source>
        <translation>Benchmark vollständig: Für {late} von {number} Zielen war die Zeit abgelaufen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Stopped: the benchmarking module cannot continue: {why}</source>
        <translation>Gestoppt: Das Benchmark-Modul kann nicht weitermachen: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Benchmarking module not connected: the run is paused until it is back</source>
        <translation>Benchmark-Modul nicht verbunden: Der Lauf ist pausiert, bis es wieder da ist</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Manual operation: {text}</source>
        <translation>Handeingriff: {text}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Goal completed by the robot</source>
        <translation>Der Roboter hat das Ziel erledigt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Goal timed out</source>
        <translation>Zeit des Ziels abgelaufen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>the benchmarking module is missing</source>
        <translation>das Benchmark-Modul fehlt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>manual operation</source>
        <translation>Handeingriff</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Benchmark timeout: {time}</source>
        <translation>Zeitlimit des Benchmarks: {time}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/functionality.py"/>
        <source>Benchmark timeout: {time} (paused)</source>
        <translation>Zeitlimit des Benchmarks: {time} (angehalten)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>The robot did not answer STOP: stop it by hand. The box repeats STOP until the disconnect</source>
        <translation>Der Roboter hat nicht auf STOPP geantwortet: Halten Sie ihn von Hand an. Die Box wiederholt STOPP, bis Sie trennen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>The robot has stayed in STOP for {time} s after the start. Its program may not know benchmark {code}, or may not be ready: check the robot&apos;s log</source>
        <translation>Der Roboter ist {time} s nach dem Start noch in STOP. Vielleicht kennt sein Programm den Benchmark {code} nicht, oder es ist nicht bereit: Sehen Sie in das Log des Roboters</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>The robot has not taken its goal for {time} s. Its program may be too old for the goals of {code}: check the robot&apos;s log</source>
        <translation>Der Roboter hat sein Ziel seit {time} s nicht angenommen. Vielleicht ist sein Programm zu alt für die Ziele von {code}: Sehen Sie in das Log des Roboters</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>Connected: waiting for the robot&apos;s first message</source>
        <translation>Verbunden: warte auf die erste Nachricht des Roboters</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>Robot preparing for the task</source>
        <translation>Der Roboter bereitet sich auf die Aufgabe vor</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>Robot prepared, executing (no explicit goal)</source>
        <translation>Der Roboter ist vorbereitet und arbeitet (ohne ausdrückliches Ziel)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>Robot fell back to {state}: preparing again</source>
        <translation>Der Roboter ist auf {state} zurückgefallen: Er bereitet sich neu vor</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>The robot reports STOP, and the box cannot know why: the referee decides</source>
        <translation>Der Roboter meldet STOP, und die Box kann nicht wissen, warum: Der Schiedsrichter entscheidet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>The robot reports STOP, and the box cannot know why: it was restarted, or does not reach its standby. If the run was stopped, press STOP. If it was not, continue the run: then the robot prepares again, and may move</source>
        <translation>Der Roboter meldet STOP, und die Box kann nicht wissen, warum: Sie wurde neu gestartet oder erreicht ihren Standby nicht. Wurde der Lauf gestoppt, drücken Sie STOP. Wenn nicht, setzen Sie ihn fort: Dann bereitet sich der Roboter wieder vor und kann sich bewegen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>The box was restarted, and has not heard the robot since: it may have been stopped, or still be moving. If the run was stopped, press STOP. If it was not, continue the run: then the robot may move</source>
        <translation>Die Box wurde neu gestartet und hat den Roboter seither nicht gehört: Er kann gestoppt worden sein oder sich noch bewegen. Wurde der Lauf gestoppt, drücken Sie STOP. Wenn nicht, setzen Sie ihn fort: Dann kann sich der Roboter bewegen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>The referee continues the run</source>
        <translation>Der Schiedsrichter setzt den Lauf fort</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>{end} (recorded after a restart)</source>
        <translation>{end} (nach einem Neustart eingetragen)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/run.py"/>
        <source>Messages saved: {number}</source>
        <translation>Gespeicherte Nachrichten: {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/times.py"/>
        <source>by the referee</source>
        <translation>durch den Schiedsrichter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/times.py"/>
        <source>The setup time of {time} is over</source>
        <translation>Die Aufbauzeit von {time} ist vorbei</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/times.py"/>
        <source>The {time} of {phase} are over</source>
        <translation>Die Zeit von {phase} ({time}) ist vorbei</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/times.py"/>
        <source>phase {number} of {all}, {name}</source>
        <translation>Phase {number} von {all}, {name}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/runs/times.py"/>
        <source>Phase {number} of {all}, {name}: {desc}</source>
        <translation>Phase {number} von {all}, {name}: {desc}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>Listening for another box before transmitting: {time} s</source>
        <translation>Horche vor dem Senden auf eine andere Box: {time} s</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>Several robots of team {team} are active ({robots}): choose which one connects</source>
        <translation>Mehrere Roboter von Team {team} sind aktiv ({robots}): Wählen Sie, welcher sich verbindet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>All OK for start</source>
        <translation>Bereit zum Starten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>Can be restarted. The clock is stopped</source>
        <translation>Kann wieder gestartet werden. Die Uhr steht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>Can be restarted. The clock kept running</source>
        <translation>Kann wieder gestartet werden. Die Uhr lief weiter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>START would begin the benchmark again: what was measured so far would not count</source>
        <translation>START würde den Benchmark von vorn beginnen: Was bisher gemessen wurde, würde nicht zählen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>START would continue the run: its next end would count instead of this one</source>
        <translation>START würde den Lauf fortsetzen: Sein nächstes Ende würde statt diesem zählen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>Clock paused by the referee</source>
        <translation>Uhr vom Schiedsrichter angehalten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>Attempt {number} of {all}</source>
        <translation>Versuch {number} von {all}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>Robot ready to accept connection: {robot}</source>
        <translation>Roboter bereit zum Verbinden: {robot}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>No robot of team {team} is heard: people start it and stop it, with the clock</source>
        <translation>Kein Roboter von Team {team} ist zu hören: Menschen starten und stoppen ihn, mit der Uhr</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>{number} robots ready to accept connection: {robots}</source>
        <translation>{number} Roboter bereit zum Verbinden: {robots}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/views/document.py"/>
        <source>The end of the run is not recorded yet: write it down until this line is gone</source>
        <translation>Das Ende des Laufs ist noch nicht aufgezeichnet: Schreiben Sie es auf, bis diese Zeile verschwunden ist</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/watches.py"/>
        <source>ANOTHER RSBB is transmitting from {address}, and robots obey both: stop it, or take that computer off the network</source>
        <translation>EINE ANDERE RSBB sendet von {address}, und die Roboter gehorchen beiden: Stoppen Sie sie, oder nehmen Sie diesen Computer vom Netz</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/watches.py"/>
        <source>ANOTHER RSBB was heard at {address}, so this box sends nothing until you press connect. Stop the other box first, or take that computer off the network if it is none of yours</source>
        <translation>EINE ANDERE RSBB war von {address} zu hören. Diese Box sendet daher nichts, bis Sie Verbinden drücken. Stoppen Sie zuerst die andere Box, oder nehmen Sie diesen Computer vom Netz, wenn er keiner von Ihren ist</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/watches.py"/>
        <source>Beacons of {robot} from {address} show two clocks: somebody forges this address, or two programs there use the name. Start uses the clock of the one that knows the password. Find the other one and take it off the network</source>
        <translation>Beacons von {robot} von {address} zeigen zwei Uhren: Jemand fälscht diese Adresse, oder zwei Programme dort nutzen den Namen. Starten nimmt die Uhr dessen, der das Passwort kennt. Suchen Sie den anderen, und nehmen Sie ihn vom Netz</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/watches.py"/>
        <source>Two robots call themselves {robot}: {address} (confirmed by its password) and {others}. Connect and start use the one that knows the password. Give the other one another robot_name, or take it off the network</source>
        <translation>Zwei Roboter nennen sich {robot}: {address} (durch sein Passwort bestätigt) und {others}. Verbinden und Starten nehmen den, der das Passwort kennt. Geben Sie dem anderen einen anderen robot_name, oder nehmen Sie ihn vom Netz</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/watches.py"/>
        <source>Two robots call themselves {robot}: {address} (confirmed by its password) and {others}. Connect and start use the one that knows the password. Give the other one another robot_name, or take it off the network. Their clocks differ: {skew} and {other}</source>
        <translation>Zwei Roboter nennen sich {robot}: {address} (durch sein Passwort bestätigt) und {others}. Verbinden und Starten nehmen den, der das Passwort kennt. Geben Sie dem anderen einen anderen robot_name, oder nehmen Sie ihn vom Netz. Ihre Uhren weichen ab: {skew} und {other}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/watches.py"/>
        <source>Two robots call themselves {robot}: {address} and {others}. Connect and start use the one that knows the password. Give the other one another robot_name, or take it off the network</source>
        <translation>Zwei Roboter nennen sich {robot}: {address} und {others}. Verbinden und Starten nehmen den, der das Passwort kennt. Geben Sie dem anderen einen anderen robot_name, oder nehmen Sie ihn vom Netz</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/watches.py"/>
        <source>Two robots call themselves {robot}: {address} and {others}. Connect and start use the one that knows the password. Give the other one another robot_name, or take it off the network. Their clocks differ: {skew} and {other}</source>
        <translation>Zwei Roboter nennen sich {robot}: {address} und {others}. Verbinden und Starten nehmen den, der das Passwort kennt. Geben Sie dem anderen einen anderen robot_name, oder nehmen Sie ihn vom Netz. Ihre Uhren weichen ab: {skew} und {other}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/zones.py"/>
        <source>No run is connected: press connect first</source>
        <translation>Kein Lauf ist verbunden: Drücken Sie zuerst Verbinden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/zones.py"/>
        <source>No run is connected, so there is nothing to stop</source>
        <translation>Kein Lauf ist verbunden, also gibt es nichts zu stoppen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/zones.py"/>
        <source>zone &apos;{zone}&apos; has no event &apos;{event}&apos; any more: choose it again</source>
        <translation>Zone „{zone}“ hat den Termin „{event}“ nicht mehr: Wählen Sie ihn noch einmal</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/core/zones.py"/>
        <source>no zone &apos;{zone}&apos;{hint}</source>
        <translation>keine Zone „{zone}“{hint}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/devices/devices.py"/>
        <source>there is no device {name}, or its value is not a whole number: give one of {names}</source>
        <translation>Es gibt kein Gerät {name}, oder sein Wert ist keine ganze Zahl: Geben Sie eines von {names} an</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/journal/copy_folder.py"/>
        <source>its disk failed to save what was written. It is written again, and what was there before stays until that is complete. If this happens again, replace the disk</source>
        <translation>Sein Datenträger hat nicht gespeichert, was geschrieben wurde. Es wird noch einmal geschrieben, und was vorher da war, bleibt, bis das vollständig ist. Wenn das wieder vorkommt, ersetzen Sie den Datenträger</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/journal/copy_folder.py"/>
        <source>another box or copy uses the folder. Use another folder, or end that one</source>
        <translation>eine andere Box oder eine andere Kopie benutzt den Ordner. Nehmen Sie einen anderen Ordner, oder beenden Sie jene</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/journal/copy_folder.py"/>
        <source>the disk is full. Free space for {folder}</source>
        <translation>Der Datenträger ist voll. Schaffen Sie Platz für {folder}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/journal/copy_folder.py"/>
        <source>{error}. Check the disk or stick of the copy</source>
        <translation>{error}. Prüfen Sie den Datenträger oder Stick der Kopie</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/journal/copy_folder.py"/>
        <source>the stick is not mounted. Plug it in again</source>
        <translation>der Stick ist nicht eingehängt. Stecken Sie ihn wieder ein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/journal/copy_folder.py"/>
        <source>the folder is missing. Plug the stick in again</source>
        <translation>der Ordner fehlt. Stecken Sie den Stick wieder ein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/journal/copy_folder.py"/>
        <source>it was removed. Plug the stick in again</source>
        <translation>er wurde entfernt. Stecken Sie den Stick wieder ein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/journal/copy_folder.py"/>
        <source>it was replaced. Plug the stick in again</source>
        <translation>er wurde ausgetauscht. Stecken Sie den Stick wieder ein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>{question}. For another attempt, press the button again and confirm</source>
        <translation>{question}. Drücken Sie für einen weiteren Versuch noch einmal auf den Knopf, und bestätigen Sie</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The run of {code}, team {team}, round {round}, run {run} is not signed off: confirm to leave it</source>
        <translation>Der Lauf von {code}, Team {team}, Runde {round}, Lauf {run} ist nicht abgeschlossen: Bestätigen Sie, dass Sie ihn verlassen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Another attempt at an event that is signed off</source>
        <translation>Ein weiterer Versuch bei einem Termin, der abgeschlossen ist</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Number</source>
        <translation>Nummer</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Device</source>
        <translation>Gerät</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Id of the mark</source>
        <translation>Kennung der Wertung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Role</source>
        <translation>Rolle</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Made so long ago</source>
        <translation>Eingegeben vor</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>To zone</source>
        <translation>In Zone</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>To time</source>
        <translation>Auf Zeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Connect</source>
        <translation>Verbinden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Open the private channel to the team&apos;s robot</source>
        <translation>Den privaten Kanal zum Roboter des Teams öffnen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Disconnect</source>
        <translation>Trennen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Leave the run and close the channel</source>
        <translation>Den Lauf verlassen und den Kanal schließen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>▶ START</source>
        <translation>▶ START</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Start the run, also after a stop</source>
        <translation>Den Lauf starten, auch nach einem Stopp</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Stop the run. It stays connected</source>
        <translation>Den Lauf stoppen. Er bleibt verbunden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>◀ Previous</source>
        <translation>◀ Voriger</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Go to the zone&apos;s previous event</source>
        <translation>Zum vorigen Termin der Zone gehen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Next ▶</source>
        <translation>Nächster ▶</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Go to the zone&apos;s next event</source>
        <translation>Zum nächsten Termin der Zone gehen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>◀ Phase</source>
        <translation>◀ Phase</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Go back to the phase before; its time continues</source>
        <translation>Zur vorigen Phase zurückgehen; ihre Zeit läuft weiter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Next phase ▶</source>
        <translation>Nächste Phase ▶</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Go to the next phase</source>
        <translation>Zur nächsten Phase gehen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>▶ Not stopped: continue</source>
        <translation>▶ Nicht gestoppt: fortsetzen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>After a restart: the run was not stopped. The robot prepares again, and may move</source>
        <translation>Nach einem Neustart: Der Lauf wurde nicht gestoppt. Der Roboter bereitet sich wieder vor und kann sich bewegen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>‖ Pause</source>
        <translation>‖ Pause</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Stop the clock of the run. The robot does not notice</source>
        <translation>Die Uhr des Laufs anhalten. Der Roboter merkt davon nichts</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>▶ Resume clock</source>
        <translation>▶ Uhr fortsetzen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Let the clock of the run continue</source>
        <translation>Die Uhr des Laufs weiterlaufen lassen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Score without a robot</source>
        <translation>Ohne Roboter werten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Start and stop the clock yourself. Nothing is sent to a robot</source>
        <translation>Die Uhr selbst starten und stoppen. An den Roboter wird nichts gesendet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>No-show</source>
        <translation>Nicht angetreten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The team did not appear. Leave this event</source>
        <translation>Das Team ist nicht erschienen. Diesen Termin verlassen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Team withdrew</source>
        <translation>Team hat zurückgezogen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The team withdrew. Leave this event</source>
        <translation>Das Team hat zurückgezogen. Diesen Termin verlassen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Choose the event</source>
        <translation>Termin wählen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Go to this event of the zone&apos;s schedule</source>
        <translation>Zu diesem Termin im Zeitplan der Zone gehen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Of a benchmarking module, whose form is filled in; without a number: the current one</source>
        <translation>Eines Benchmark-Moduls, dessen Formular ausgefüllt ist; ohne Nummer: der aktuelle</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>A switch changed</source>
        <translation>Ein Schalter hat sich geändert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Toggle the mark of a switch, counted from 1</source>
        <translation>Die Markierung eines Schalters umstellen, von 1 gezählt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Set how many switches were damaged</source>
        <translation>Angeben, wie viele Schalter beschädigt wurden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Confirm the switches</source>
        <translation>Schalter bestätigen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>All switches that the robot changed are entered</source>
        <translation>Alle Schalter, die der Roboter geändert hat, sind eingetragen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Group</source>
        <translation>Gruppe</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Item</source>
        <translation>Kriterium</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>What to add</source>
        <translation>Was hinzukommt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Mark an item</source>
        <translation>Ein Kriterium werten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Set an item of the score sheet, or add to it</source>
        <translation>Ein Kriterium des Wertungsbogens setzen oder dazuzählen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Mark an item of a judge</source>
        <translation>Ein Kriterium als Juror werten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>On the judge&apos;s own sheet</source>
        <translation>Auf dem eigenen Wertungsbogen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Withdraw the entry</source>
        <translation>Eintrag zurücknehmen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The entry of the score sheet no longer counts; others stay</source>
        <translation>Der Eintrag des Wertungsbogens zählt nicht mehr; andere bleiben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>It was in time</source>
        <translation>Es war rechtzeitig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>What an entry marks was seen before the time limit, so it counts; it was entered later</source>
        <translation>Was ein Eintrag wertet, geschah vor dem Zeitlimit, zählt also; eingetragen wurde es später</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Take back the mark</source>
        <translation>Wertung zurücknehmen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>A mark that set an item no longer counts</source>
        <translation>Eine Wertung, die einen Punkt gesetzt hat, zählt nicht mehr</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Note this moment</source>
        <translation>Moment merken</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>With the clock of the run. Its text can be entered later: name the note by its number or its id</source>
        <translation>Mit der Uhr des Laufs. Der Text kann später eingegeben werden: Notiz mit ihrer Nummer oder Id nennen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Captain&apos;s signature</source>
        <translation>Unterschrift des Kapitäns</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The captain read the score sheet of a run that is over, and signs it or refuses, with the reason</source>
        <translation>Der Kapitän hat den Wertungsbogen eines beendeten Laufs gelesen und unterschreibt ihn, oder lehnt mit Grund ab</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Decide on a late mark</source>
        <translation>Über eine verspätete Wertung entscheiden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>It was made before the sign-off and arrived after it. If it is accepted, you sign the new sheet</source>
        <translation>Sie wurde vor dem Abschluss eingegeben und kam danach an. Wer sie annimmt, schließt den neuen Bogen ab</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Annul the run</source>
        <translation>Lauf annullieren</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>It is kept and shown, counts nothing, and gives its attempt back</source>
        <translation>Er bleibt erhalten und sichtbar, zählt nichts und gibt seinen Versuch zurück</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Move the run</source>
        <translation>Lauf verschieben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>To the right event of the same benchmark: of another team, round or time</source>
        <translation>Zum richtigen Termin desselben Benchmarks: eines anderen Teams, einer anderen Runde oder Zeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Reopen the sheet</source>
        <translation>Bogen wieder öffnen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>A signed sheet can be corrected again. It is kept; the next sign-off makes a new version</source>
        <translation>Ein abgeschlossener Bogen kann wieder korrigiert werden. Er bleibt erhalten; der nächste Abschluss macht eine neue Fassung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Take it back</source>
        <translation>Zurücknehmen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The last of annulled, moved and reopened no longer holds for the run</source>
        <translation>Das letzte Annullieren, Verschieben oder Öffnen gilt für den Lauf nicht mehr</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Record why it ended</source>
        <translation>Festhalten, warum er endete</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Possible until the run is signed off</source>
        <translation>Möglich, bis der Lauf abgeschlossen ist</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The score sheet of a run that is over becomes final</source>
        <translation>Der Wertungsbogen eines beendeten Laufs wird endgültig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The judge&apos;s own sheet is locked</source>
        <translation>Der eigene Bogen wird gesperrt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Settle</source>
        <translation>Entscheiden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The head referee gives the item on which judges differ its value</source>
        <translation>Der Hauptschiedsrichter gibt dem Punkt seinen Wert, bei dem die Juroren abweichen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Hand back: look again</source>
        <translation>Zurückgeben: noch einmal prüfen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The judge looks again, and submits again</source>
        <translation>Der Juror sieht noch einmal hin und gibt noch einmal ab</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Withdraw the sheet</source>
        <translation>Bogen zurückziehen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The judge&apos;s sheet no longer counts; another can take its place</source>
        <translation>Der Bogen zählt nicht mehr; ein anderer kann seinen Platz einnehmen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Do not wait for missing judges</source>
        <translation>Nicht auf fehlende Jurymitglieder warten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The run is scored with the sheets that are there</source>
        <translation>Der Lauf wird mit den vorhandenen Bögen gewertet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Publish as provisional</source>
        <translation>Als vorläufig veröffentlichen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Objections are possible for some time; -1: as the benchmarks file says</source>
        <translation>Einsprüche sind eine Zeit lang möglich; -1: wie die Benchmark-Datei sagt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Enter an objection</source>
        <translation>Einspruch eintragen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>To a result, also a protest after the sign-off: as long as the rules allow it</source>
        <translation>Gegen ein Ergebnis, auch als Protest nach dem Abschluss: solange die Regeln es erlauben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Answer the objection</source>
        <translation>Einspruch beantworten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The sheet is corrected separately: one that is upheld reopens a signed sheet</source>
        <translation>Der Bogen wird eigens korrigiert: ein Einspruch, dem stattgegeben wird, öffnet einen abgeschlossenen Bogen wieder</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>A zone is late</source>
        <translation>Eine Zone ist verspätet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Shift the events of a zone that are to come today, by minutes such as 40, or so that the next one begins at a time such as 14:20</source>
        <translation>Die heute noch kommenden Termine einer Zone um Minuten verschieben, etwa 40, oder so, dass der nächste zu einer Zeit wie 14:20 beginnt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Swap two events</source>
        <translation>Zwei Termine tauschen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Two events exchange their times and zones</source>
        <translation>Zwei Termine tauschen Zeit und Zone</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Move an event</source>
        <translation>Einen Termin verlegen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>To a time such as 14:20, a day such as 2026-11-30, both, or another zone</source>
        <translation>Auf eine Zeit wie 14:20, einen Tag wie 2026-11-30, beides, oder in eine andere Zone</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Add an event</source>
        <translation>Einen Termin hinzufügen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>A new event of a team, at a time such as 14:20</source>
        <translation>Ein neuer Termin eines Teams, zu einer Zeit wie 14:20</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Remove an event</source>
        <translation>Einen Termin streichen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>It will not take place</source>
        <translation>Er findet nicht statt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Repeat an event</source>
        <translation>Einen Termin wiederholen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>The team gets the same event again, after the last one of the zone or at a time such as 14:20</source>
        <translation>Das Team bekommt denselben Termin noch einmal, nach dem letzten der Zone oder zu einer Zeit wie 14:20</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>A team withdraws</source>
        <translation>Ein Team zieht zurück</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>From all events to come, those of a day, or one</source>
        <translation>Von allen kommenden Terminen, denen eines Tages, oder einem</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>A late team</source>
        <translation>Ein spätes Team</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>With a password, and an event for each benchmark and round that other teams do from today on</source>
        <translation>Mit Passwort und einem Termin für jeden Benchmark und jede Runde, die andere Teams von heute an haben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Teams advance</source>
        <translation>Teams kommen weiter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Those who advance from a stage, such as to the Final, take the places of its events, the best team last; with a time, its events begin there</source>
        <translation>Wer aus einer Stufe weiterkommt, etwa ins Finale, bekommt dessen Termine, das beste Team zuletzt; mit einer Zeit beginnen sie dann</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Put the events of an edit back, if nobody changed them since</source>
        <translation>Die Termine einer Änderung zurücksetzen, wenn sie seither niemand geändert hat</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Connect in {zone}</source>
        <translation>Verbinden in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Disconnect in {zone}</source>
        <translation>Trennen in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Start in {zone}</source>
        <translation>Starten in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Previous in {zone}</source>
        <translation>Voriger Termin in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Next in {zone}</source>
        <translation>Nächster Termin in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Previous phase in {zone}</source>
        <translation>Vorige Phase in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Next phase in {zone}</source>
        <translation>Nächste Phase in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Was the run of team {team} not stopped? Its robot prepares again, and may move.</source>
        <translation>Wurde der Lauf von Team {team} nicht gestoppt? Sein Roboter bereitet sich wieder vor und kann sich bewegen.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Continue in {zone}</source>
        <translation>Fortsetzen in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Pause in {zone}</source>
        <translation>Pause in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Resume in {zone}</source>
        <translation>Fortsetzen in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Score sheet in {zone}</source>
        <translation>Wertungsbogen in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Did team {team} not appear? The zone leaves this event.</source>
        <translation>Ist Team {team} nicht erschienen? Die Zone verlässt diesen Termin.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>No-show in {zone}</source>
        <translation>Nicht angetreten in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Did team {team} withdraw? The zone leaves this event.</source>
        <translation>Hat Team {team} zurückgezogen? Die Zone verlässt diesen Termin.</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Withdrawal in {zone}</source>
        <translation>Rückzug in {zone}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Also a run in progress</source>
        <translation>Auch einen laufenden Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Reason for the stop</source>
        <translation>Grund des Stopps</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Also leave a run that is not signed off</source>
        <translation>Auch einen Lauf verlassen, der nicht abgeschlossen ist</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Answer</source>
        <translation>Antwort</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>No, it was late</source>
        <translation>Nein, es war zu spät</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Id of the note</source>
        <translation>Id der Notiz</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Name of the captain</source>
        <translation>Name des Kapitäns</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Signature</source>
        <translation>Unterschrift</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Refuses to sign</source>
        <translation>Lehnt die Unterschrift ab</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Accept it</source>
        <translation>Annehmen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Time for objections</source>
        <translation>Zeit für Einsprüche</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Second of the run that it is about</source>
        <translation>Sekunde des Laufs, um die es geht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Upheld</source>
        <translation>Stattgegeben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Minutes, or time</source>
        <translation>Minuten oder Zeit</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Other event</source>
        <translation>Anderer Termin</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Only this day</source>
        <translation>Nur dieser Tag</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Only this event</source>
        <translation>Nur dieser Termin</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Name that its robot announces</source>
        <translation>Name, den sein Roboter meldet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Stage, if several have finalists</source>
        <translation>Stufe, wenn mehrere Finalisten haben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/actions.py"/>
        <source>Minutes from one to the next</source>
        <translation>Minuten von einem zum nächsten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>{field}: a text is expected</source>
        <translation>{field}: Ein Text wird erwartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>{field}: the text has {number} characters, at most {most} are allowed: shorten it</source>
        <translation>{field}: Der Text hat {number} Zeichen, höchstens {most} sind erlaubt: Kürzen Sie ihn</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>{field}: a whole number from {low} to {high} is expected</source>
        <translation>{field}: Eine ganze Zahl von {low} bis {high} wird erwartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>{field}: a number from {low} to {high} is expected</source>
        <translation>{field}: Eine Zahl von {low} bis {high} wird erwartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>{field}: &apos;{text}&apos; can mean {whole} or {decimal}. Type {whole}, or {decimal} (with a comma: {comma})</source>
        <translation>{field}: „{text}“ kann {whole} oder {decimal} heißen. Geben Sie {whole} oder {decimal} ein (mit Komma: {comma})</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>{field}: x and y in metres, then the direction in degrees, are expected, such as 1.25 0.40 90</source>
        <translation>{field}: x und y in Metern, dann die Richtung in Grad, werden erwartet, zum Beispiel 1.25 0.40 90</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>{field}: [x, y, theta] is expected: metres, and radians from -6.3 to 6.3</source>
        <translation>{field}: [x, y, theta] wird erwartet: Meter, und Radiant von -6,3 bis 6,3</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>{field}: choose one of {choices}</source>
        <translation>{field}: Wählen Sie aus {choices}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>{field} is missing</source>
        <translation>{field} fehlt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>The command has no field &apos;{field}&apos;: it has {fields}</source>
        <translation>Der Befehl hat kein Feld „{field}“: Er hat {fields}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>The command has no field &apos;{field}&apos;: it has none</source>
        <translation>Der Befehl hat kein Feld „{field}“: Er hat keine</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>{field}: yes or no is expected</source>
        <translation>{field}: Ja oder nein wird erwartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/fields.py"/>
        <source>{field}: true or false is expected</source>
        <translation>{field}: true oder false wird erwartet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/modules.py"/>
        <source>Another answer</source>
        <translation>Andere Antwort</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/reason.py"/>
        <source>the note has {number} characters: at most {most} are kept, shorten it</source>
        <translation>die Notiz hat {number} Zeichen: Höchstens {most} werden behalten, kürzen Sie sie</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/records.py"/>
        <source>Benchmark stopped by the referee</source>
        <translation>Benchmark vom Schiedsrichter gestoppt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/records.py"/>
        <source>Benchmark completed by the robot</source>
        <translation>Der Roboter hat den Benchmark erledigt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/records.py"/>
        <source>Stopped due to timeout</source>
        <translation>Gestoppt, weil die Zeit abgelaufen ist</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/records.py"/>
        <source>Benchmark over: every goal timed out</source>
        <translation>Benchmark vorbei: Die Zeit aller Ziele ist abgelaufen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/records.py"/>
        <source>Stopped: the robot saves no offline data (messages saved stays 0)</source>
        <translation>Gestoppt: Der Roboter speichert keine Offline-Daten (gespeicherte Nachrichten: weiter 0)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/records.py"/>
        <source>Stopped: the benchmarking module cannot continue</source>
        <translation>Gestoppt: Das Benchmark-Modul kann nicht weitermachen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/records.py"/>
        <source>No-show: the team did not appear</source>
        <translation>Nicht angetreten: Das Team ist nicht erschienen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/model/records.py"/>
        <source>The team withdrew</source>
        <translation>Das Team hat zurückgezogen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>The schedule has no such event any more: look at it again</source>
        <translation>Der Zeitplan hat diesen Termin nicht mehr: Sehen Sie ihn noch einmal an</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{event} is over, or in progress: &apos;repeat&apos; gives the team another one</source>
        <translation>{event} ist vorbei oder läuft: &apos;repeat&apos; gibt dem Team einen weiteren</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>Zone &apos;{zone}&apos; has no event to come</source>
        <translation>Zone &apos;{zone}&apos; hat keinen Termin mehr vor sich</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>There is no zone &apos;{zone}&apos;</source>
        <translation>Es gibt keine Zone &apos;{zone}&apos;</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{event} is the only event of zone &apos;{zone}&apos;, which cannot be empty</source>
        <translation>{event} ist der einzige Termin der Zone &apos;{zone}&apos;, die nicht leer sein kann</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>&apos;{text}&apos; is no time: expected such as 14:20, or 2026-11-29 14:20</source>
        <translation>&apos;{text}&apos; ist keine Zeit: erwartet wird etwa 14:20 oder 2026-11-29 14:20</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>&apos;{text}&apos; is no delay: expected minutes such as 40 or -10, or the time of the next event such as 14:20</source>
        <translation>&apos;{text}&apos; ist keine Verspätung: erwartet werden Minuten wie 40 oder -10, oder die Zeit des nächsten Termins wie 14:20</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{text} does not exist: the clocks skip it</source>
        <translation>{text} gibt es nicht: Die Uhren überspringen es</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>That is more than a day: move the events</source>
        <translation>Das ist mehr als ein Tag: Verlegen Sie die Termine</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>Nothing would change</source>
        <translation>Nichts würde sich ändern</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>Choose two different events</source>
        <translation>Wählen Sie zwei verschiedene Termine</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{event} was changed since: nothing was undone</source>
        <translation>{event} wurde seither geändert: Nichts wurde rückgängig gemacht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{number} teams advance, and {places} events of {test} are planned: give the time of the first one, and the zone</source>
        <translation>{number} Teams kommen weiter, und {places} Termine von {test} sind geplant: Geben Sie die Zeit des ersten an, und die Zone</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>Team {team} is there already</source>
        <translation>Team {team} gibt es schon</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{event}: removed (it was at {time} in zone &apos;{zone}&apos;)</source>
        <translation>{event}: gestrichen (war um {time} in Zone &apos;{zone}&apos;)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{event}: {time} in zone &apos;{zone}&apos; instead of {before} in zone &apos;{other}&apos;</source>
        <translation>{event}: {time} in Zone &apos;{zone}&apos; statt {before} in Zone &apos;{other}&apos;</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>Team {team} is in two zones at once: {event} at {time}, {other} at {then}</source>
        <translation>Team {team} ist in zwei Zonen zugleich: {event} um {time}, {other} um {then}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>Team {team} has less than {minutes} minutes between {event} ({time}) and {other} ({then})</source>
        <translation>Team {team} hat weniger als {minutes} Minuten zwischen {event} ({time}) und {other} ({then})</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>Zone &apos;{zone}&apos;: {other} at {then} begins before the end of {event} ({time})</source>
        <translation>Zone &apos;{zone}&apos;: {other} um {then} beginnt vor dem Ende von {event} ({time})</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{event} at {time} ends after midnight</source>
        <translation>{event} um {time} endet nach Mitternacht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{code} of {team}</source>
        <translation>{code} von {team}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{event}: {time} instead of {before}</source>
        <translation>{event}: {time} statt {before}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{event}: {time} in zone &apos;{zone}&apos;, added</source>
        <translation>{event}: {time} in Zone &apos;{zone}&apos;, neu</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{event}: {time} has passed</source>
        <translation>{event}: {time} ist vorbei</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/day.py"/>
        <source>{number} events are at times that have passed</source>
        <translation>{number} Termine sind zu Zeiten, die vorbei sind</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/schedule_text.py"/>
        <source>The schedule file has an event that does not begin with &apos;- &apos; on a line of its own: write each so, and reload</source>
        <translation>In der Datei des Zeitplans beginnt ein Termin nicht mit &apos;- &apos; in einer eigenen Zeile: Schreiben Sie jeden so, und laden Sie neu</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/team_passwords.py"/>
        <source>&apos;{team}&apos; cannot be added to {path}: it is no name of a team, or the file does not end with a line &apos;team: password&apos;</source>
        <translation>&apos;{team}&apos; kann nicht in {path} eingetragen werden: Es ist kein Name eines Teams, oder die Datei endet nicht mit einer Zeile &apos;Team: Passwort&apos;</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/rulebook/team_passwords.py"/>
        <source>{path} cannot be read: {error}</source>
        <translation>{path} kann nicht gelesen werden: {error}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>a sign-off needs the name of the referee: enter it, in the terminal with --by</source>
        <translation>zum Abschließen fehlt der Name des Schiedsrichters: Geben Sie ihn ein, im Terminal mit --by</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>the run was not stopped yet, so it cannot have a reason</source>
        <translation>der Lauf wurde noch nicht gestoppt, also kann er keinen Grund haben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>enter the name of the captain</source>
        <translation>Geben Sie den Namen des Kapitäns ein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>enter why the captain refuses to sign</source>
        <translation>Geben Sie ein, warum der Kapitän nicht unterschreibt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>the signature is not made of lines such as M10 20L30 40</source>
        <translation>Die Unterschrift besteht nicht aus Linien wie M10 20L30 40</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>the run is annulled already</source>
        <translation>der Lauf ist schon annulliert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>the score sheet is not signed off: correct it</source>
        <translation>der Bogen ist nicht abgeschlossen: ihn einfach korrigieren</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>nothing was annulled, moved or reopened that could be taken back</source>
        <translation>nichts wurde annulliert, verschoben oder geöffnet, das zurückgenommen werden könnte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>the score sheet was changed since it was reopened: withdraw the changes, or sign it off again</source>
        <translation>der Bogen wurde seit dem Öffnen geändert: die Änderungen zurückziehen oder ihn neu abschließen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>enter why: the reason is kept with the score sheet</source>
        <translation>den Grund eingeben: er bleibt beim Wertungsbogen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>the run has no stop {number}: choose from 1 to {count}, or 0 for the last one</source>
        <translation>der Lauf hat keinen Stopp {number}: Wählen Sie von 1 bis {count}, oder 0 für den letzten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>the run has no note {number}</source>
        <translation>Der Lauf hat keine Notiz {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>{most} marks that came after the sign-off are proposed, which is the most</source>
        <translation>{most} Wertungen, die nach dem Abschluss kamen, sind vorgeschlagen: mehr sind nicht möglich</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>the run has no proposed mark {number}</source>
        <translation>Der Lauf hat keine vorgeschlagene Wertung {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>{who} has decided on the proposed mark {number} already</source>
        <translation>{who} hat über die vorgeschlagene Wertung {number} schon entschieden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>{count} judges score this benchmark, each on a sheet of their own: enter the score as a judge, or settle the item with a reason as the head referee</source>
        <translation>{count} Juroren werten diesen Benchmark, jeder auf einem eigenen Bogen: Werten Sie als Juror, oder entscheiden Sie den Punkt als Hauptschiedsrichter mit Begründung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>the score sheet of run {run} was signed off by {who} at {time}: it is final. To correct it, reopen it in Results, with the reason</source>
        <translation>der Wertungsbogen des Laufs {run} wurde von {who} um {time} abgeschlossen: Er ist endgültig. Zum Korrigieren unter Ergebnisse mit Grund wieder öffnen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>&apos;{run}&apos; is not one of the newest {most} runs that are over: the program &apos;results&apos; shows it</source>
        <translation>„{run}“ ist keiner der neuesten {most} Läufe, die vorbei sind: Das Programm &apos;results&apos; zeigt ihn</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/book.py"/>
        <source>the run has {most} notes, which is the most</source>
        <translation>Der Lauf hat {most} Notizen: mehr sind nicht möglich</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>the judges differ: the head referee settles {items}</source>
        <translation>die Juroren weichen ab: Der Hauptschiedsrichter entscheidet {items}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>{missing} of {count} judges have not submitted: wait for them, or decide with a reason not to wait</source>
        <translation>{missing} von {count} Juroren haben nicht abgegeben: Warten Sie auf sie, oder entscheiden Sie mit Begründung, nicht zu warten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>{missing} of {count} judges have not submitted ({names}): wait for them, or decide with a reason not to wait</source>
        <translation>{missing} von {count} Juroren haben nicht abgegeben ({names}): Warten Sie auf sie, oder entscheiden Sie mit Begründung, nicht zu warten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>hand a sheet back</source>
        <translation>Bogen zurückgeben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>withdraw a sheet</source>
        <translation>Bogen zurückziehen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>stop waiting for missing judges</source>
        <translation>nicht auf fehlende Juroren warten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>settle an item</source>
        <translation>einen Punkt entscheiden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>no judge is missing</source>
        <translation>es fehlt kein Juror</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>settle the items after that</source>
        <translation>entscheiden Sie die Punkte danach</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>this benchmark has no judges with sheets of their own: see the key &apos;judges&apos; of the benchmarks file</source>
        <translation>dieser Benchmark hat keine Juroren mit eigenen Bögen: siehe den Schlüssel „judges“ der Benchmark-Datei</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>a judge needs a name: enter it, in the terminal with --by</source>
        <translation>ein Juror braucht einen Namen: Geben Sie ihn ein, im Terminal mit --by</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>to {what} needs the name of the head referee: enter it, in the terminal with --by</source>
        <translation>{what}: Der Name des Hauptschiedsrichters fehlt: Geben Sie ihn ein, im Terminal mit --by</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>to {what} needs a reason: type one</source>
        <translation>{what}: Die Begründung fehlt: Geben Sie eine ein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>the sheet of {judge} is submitted: ask the head referee to hand it back</source>
        <translation>der Bogen von {judge} ist abgegeben: Bitten Sie den Hauptschiedsrichter, ihn zurückzugeben</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>the sheet of {judge} was withdrawn: mark an item to begin another one</source>
        <translation>der Bogen von {judge} wurde zurückgezogen: Werten Sie einen Punkt, um einen anderen zu beginnen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>no rating of {missing}: rate it, or mark it as not attempted</source>
        <translation>keine Bewertung von {missing}: Bewerten Sie es, oder markieren Sie es als nicht versucht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>{judge} has not submitted, so the sheet cannot be handed back</source>
        <translation>{judge} hat nicht abgegeben, also kann der Bogen nicht zurückgegeben werden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>&apos;{judge}&apos; has no sheet of this run: it is judged by {names}</source>
        <translation>„{judge}“ hat keinen Bogen dieses Laufs: Es jurieren {names}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>this run already has its {count} judges ({names}): the head referee can withdraw a sheet</source>
        <translation>dieser Lauf hat schon seine {count} Juroren ({names}): Der Hauptschiedsrichter kann einen Bogen zurückziehen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>{most} sheets of judges were opened for this run: settle the items instead</source>
        <translation>{most} Bögen von Juroren wurden für diesen Lauf geöffnet: Entscheiden Sie stattdessen die Punkte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/judges.py"/>
        <source>the judges&apos; sheets of this run were changed {most} times: no more changes are kept</source>
        <translation>die Bögen der Juroren dieses Laufs wurden {most}-mal geändert: Weitere Änderungen werden nicht behalten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>objections were possible until {time}. An organiser who finds the score wrong can reopen the sheet</source>
        <translation>Einsprüche waren bis {time} möglich. Wer als Organisator die Wertung für falsch hält, kann den Bogen wieder öffnen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>objections are possible until {time}: wait, or publish again with a shorter time limit</source>
        <translation>Einsprüche sind bis {time} möglich: Warten Sie, oder veröffentlichen Sie noch einmal mit kürzerer Frist</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>publish the result as provisional first: the rules give time for objections</source>
        <translation>veröffentlichen Sie das Ergebnis zuerst als vorläufig: Die Regeln geben Zeit für Einsprüche</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>the result is not published yet: publish it as provisional first</source>
        <translation>das Ergebnis ist noch nicht veröffentlicht: Veröffentlichen Sie es zuerst als vorläufig</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>an answer to an objection needs a text: type one</source>
        <translation>eine Antwort auf einen Einspruch braucht einen Text: Geben Sie einen ein</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>answer objection {numbers} first</source>
        <translation>beantworten Sie zuerst Einspruch {numbers}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>{limit} s for objections: at most {most} are possible</source>
        <translation>{limit} s für Einsprüche: Höchstens {most} sind möglich</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>who objects</source>
        <translation>wer Einspruch erhebt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>the text of the objection</source>
        <translation>der Text des Einspruchs</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>enter {missing}</source>
        <translation>es fehlt: {missing}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>{most} objections were entered: no more are kept</source>
        <translation>{most} Einsprüche wurden eingetragen: Weitere werden nicht behalten</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>there is no objection {number}: {count} were entered</source>
        <translation>es gibt keinen Einspruch {number}: {count} wurden eingetragen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/publication.py"/>
        <source>objections were possible until {time}: the organiser can publish the result again, with another time limit</source>
        <translation>Einsprüche waren bis {time} möglich: Der Veranstalter kann das Ergebnis mit anderer Frist noch einmal veröffentlichen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>a count</source>
        <translation>eine Anzahl</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>a whole number</source>
        <translation>eine ganze Zahl</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>0 or more</source>
        <translation>0 oder mehr</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>&apos;{item}&apos; takes a number from {least} to {most} with at most {decimals} decimals, not &apos;{text}&apos;</source>
        <translation>„{item}“ nimmt eine Zahl von {least} bis {most} mit höchstens {decimals} Nachkommastellen, nicht „{text}“</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>no entry can be withdrawn</source>
        <translation>kein Eintrag kann zurückgenommen werden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>this benchmark has no scoring items for the referee</source>
        <translation>dieser Benchmark hat keine Wertungspunkte für den Schiedsrichter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>no scoring item &apos;{item}&apos; in group &apos;{group}&apos;{hint}</source>
        <translation>kein Wertungspunkt „{item}“ in der Gruppe „{group}“{hint}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>from {least} to {most}</source>
        <translation>von {least} bis {most}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>set the value without a note</source>
        <translation>setzen Sie den Wert ohne Notiz</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>set the value instead</source>
        <translation>setzen Sie stattdessen den Wert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>choose from {numbers}</source>
        <translation>wählen Sie aus {numbers}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>no scoring group &apos;{group}&apos;{hint}</source>
        <translation>keine Wertungsgruppe „{group}“{hint}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>&apos;{item}&apos; is {what}: its value must be {limits}, not {value}</source>
        <translation>„{item}“ ist {what}: Der Wert muss {limits} sein, nicht {value}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>the number {value}</source>
        <translation>die Zahl {value}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>that mark was not applied, so it cannot be taken back</source>
        <translation>jene Wertung kam nicht an, also kann sie nicht zurückgenommen werden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>that mark has no entry in the history: set the value instead</source>
        <translation>jene Wertung hat keinen Eintrag im Verlauf: Setzen Sie stattdessen den Wert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>that mark added to its item: add the opposite instead</source>
        <translation>jene Wertung hat zu ihrem Punkt addiert: Addieren Sie stattdessen das Gegenteil</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>that mark shares an entry of the history with others: set the value instead</source>
        <translation>jene Wertung teilt einen Eintrag des Verlaufs mit anderen: Setzen Sie stattdessen den Wert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>&apos;{item}&apos; takes a whole number, not the text &apos;{text}&apos;</source>
        <translation>„{item}“ nimmt eine ganze Zahl, nicht den Text „{text}“</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>&apos;{item}&apos; does not take {found}: choose one of {names}</source>
        <translation>„{item}“ nimmt {found} nicht: Wählen Sie aus {names}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>&apos;{item}&apos; has no judge &apos;{judge}&apos;: choose one of {judges}</source>
        <translation>„{item}“ hat keinen Juror „{judge}“: Wählen Sie aus {judges}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>&apos;{item}&apos; is rated by judges: name one of {judges}</source>
        <translation>„{item}“ wird von Juroren bewertet: Nennen Sie einen von {judges}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>&apos;{item}&apos; is a rating: give the number as a text</source>
        <translation>„{item}“ ist eine Bewertung: Geben Sie die Zahl als Text an</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>&apos;{item}&apos; is not rated by judges: leave out the judge</source>
        <translation>„{item}“ wird nicht von Juroren bewertet: Lassen Sie den Juror weg</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>&apos;{item}&apos; cannot be counted: set its value</source>
        <translation>„{item}“ kann nicht gezählt werden: Setzen Sie den Wert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>&apos;{item}&apos; cannot be changed by &apos;{added}&apos;: give a number such as +1 or -1</source>
        <translation>„{item}“ kann nicht um „{added}“ geändert werden: Geben Sie eine Zahl wie +1 oder -1</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>&apos;{item}&apos; is counted in whole numbers, not by &apos;{added}&apos;</source>
        <translation>„{item}“ wird in ganzen Zahlen gezählt, nicht um „{added}“</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>entry {number} was withdrawn already, by {who}</source>
        <translation>Eintrag {number} wurde schon zurückgenommen, von {who}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>entry {number} cannot be withdrawn, because later entries count from it: without it, {wrong}. Withdraw those first, or set the value</source>
        <translation>Eintrag {number} kann nicht zurückgenommen werden, weil spätere von ihm aus zählen: Ohne ihn gilt: {wrong}. Nehmen Sie zuerst jene zurück, oder setzen Sie den Wert</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>{most} entries of the score sheet already have a note or are withdrawn: {instead}</source>
        <translation>{most} Einträge des Wertungsbogens haben schon eine Notiz oder sind zurückgenommen: {instead}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>the score sheet has no entry {number}: {hint}</source>
        <translation>der Wertungsbogen hat keinen Eintrag {number}: {hint}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>&apos;{item}&apos; is yes or no: its value must be 0 or 1, not {value}</source>
        <translation>„{item}“ ist ja oder nein: Der Wert muss 0 oder 1 sein, nicht {value}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>the id &apos;{id}&apos; was used for &apos;{item}&apos;: give each mark a new UUID</source>
        <translation>die Kennung „{id}“ wurde für „{item}“ verwendet: Geben Sie jeder Wertung eine neue UUID</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>entry {number} was not late: no entry of this sheet is</source>
        <translation>Eintrag {number} war nicht zu spät: Auf diesem Bogen ist es keiner</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/sheet.py"/>
        <source>entry {number} was not late: the run had taken {time}, and its time limit is {limit}</source>
        <translation>Eintrag {number} war nicht zu spät: Der Lauf dauerte da {time}, das Zeitlimit ist {limit}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{team}, {test}: {rule} of {numbers}: {number}</source>
        <translation>{team}, {test}: {rule} von {numbers}: {number}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{team}, {test}: the attempts before the extra one do not count</source>
        <translation>{team}, {test}: die Versuche vor dem zusätzlichen zählen nicht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{team}, {test}: {points} for the team, whichever attempt counts</source>
        <translation>{team}, {test}: {points} für das Team, gleich welcher Versuch zählt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{team}, {column}: {weight} × {number} / {reference} = {points}</source>
        <translation>{team}, {column}: {weight} × {number} / {reference} = {points}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{team}, {column}: place {place} of {teams}</source>
        <translation>{team}, {column}: Platz {place} von {teams}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{team}: {sum} = {points}</source>
        <translation>{team}: {sum} = {points}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{team}: {sum}, at least {limit}: {points}</source>
        <translation>{team}: {sum}, mindestens {limit}: {points}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{team}: {name} counts at most {times} times</source>
        <translation>{team}: {name} zählt höchstens {times}-mal</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{team}: {name}</source>
        <translation>{team}: {name}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{stage}: {number} of {count} advance: {teams}</source>
        <translation>{stage}: {number} von {count} kommen weiter: {teams}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{teams} tie for {stage}, place {place}: {by} decides</source>
        <translation>{teams} sind gleich in {stage}, Platz {place}: {by} entscheidet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{stage}: {teams} tie, and {number} of them can advance: name who does in &apos;chosen&apos; of the stage (docs/results.md)</source>
        <translation>{stage}: {teams} sind gleich, und {number} davon können weiterkommen: nennen Sie sie in &apos;chosen&apos; der Stufe (docs/results.md)</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{stage}: {teams} tie, so all of them advance</source>
        <translation>{stage}: {teams} sind gleich, daher kommen alle weiter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{stage}: who advances from {before} is not decided yet</source>
        <translation>{stage}: wer aus {before} weiterkommt, ist noch nicht entschieden</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{team} has a result in {test} but did not advance: it does not count in {stage}</source>
        <translation>{team} hat ein Ergebnis in {test}, kam aber nicht weiter: es zählt nicht in {stage}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{part} counts 0: no team has more than 0</source>
        <translation>{part} zählt 0: kein Team hat mehr als 0</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/stages.py"/>
        <source>{part}: no run counts yet</source>
        <translation>{part}: noch zählt kein Lauf</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/standings.py"/>
        <source>team {team}, {turn}: {what}</source>
        <translation>Team {team}, {turn}: {what}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/standings.py"/>
        <source>team {team}, {turn}: an objection is not answered yet</source>
        <translation>Team {team}, {turn}: ein Einspruch ist noch nicht beantwortet</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/standings.py"/>
        <source>team {team}, {turn}: not signed off yet, so it does not count</source>
        <translation>Team {team}, {turn}: noch nicht abgeschlossen, zählt also nicht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/standings.py"/>
        <source>team {team} gets 0 for {part}: none of its runs counts</source>
        <translation>Team {team} erhält 0 für {part}: keiner seiner Läufe zählt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/standings.py"/>
        <source>team {team} gets 0 for {part}: its run is not signed off yet</source>
        <translation>Team {team} erhält 0 für {part}: sein Lauf ist noch nicht abgeschlossen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/standings.py"/>
        <source>team {team} has a run of {part} that is not signed off yet: it does not count</source>
        <translation>Team {team} hat einen Lauf von {part}, der noch nicht abgeschlossen ist: er zählt nicht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/standings.py"/>
        <source>{name}: {reading}</source>
        <translation>{name}: {reading}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/standings.py"/>
        <source>scored by an earlier sheet ({changed}): run {runs}</source>
        <translation>nach einem früheren Bogen bewertet ({changed}): Lauf {runs}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item} at {time}: after the limit of {limit}, so it does not count</source>
        <translation>{item} um {time}: nach dem Zeitlimit von {limit}, zählt also nicht</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item}{time}: void because of: {incident}</source>
        <translation>{item}{time}: ungültig wegen: {incident}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item}{time}: must not count: {why}</source>
        <translation>{item}{time}: darf nicht zählen: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{incident}{time}: time {number}, {times} allowed: it has no effect</source>
        <translation>{incident}{time}: zum {number}. Mal, erlaubt sind {times}: ohne Wirkung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{incident}{time}: {points} points, allowed below {below}: it has no effect</source>
        <translation>{incident}{time}: {points} Punkte, erlaubt unter {below}: ohne Wirkung</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{incident}{time}: it has no effect ({why})</source>
        <translation>{incident}{time}: ohne Wirkung ({why})</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>no {fact}</source>
        <translation>nicht: {fact}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{incident} at {time}, by itself</source>
        <translation>{incident} um {time}, von selbst</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item}: {number} × {each} = {points}</source>
        <translation>{item}: {number} × {each} = {points}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item}: {sum} = {points}</source>
        <translation>{item}: {sum} = {points}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>Total: {points}</source>
        <translation>Gesamt: {points}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>Total: {sum} = {points}</source>
        <translation>Gesamt: {sum} = {points}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item}: {sum}, at least {limit}: {points}</source>
        <translation>{item}: {sum}, mindestens {limit}: {points}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item}: {sum}, at most {limit}: {points}</source>
        <translation>{item}: {sum}, höchstens {limit}: {points}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item}: {number} ×, only {times} × count</source>
        <translation>{item}: {number} ×, nur {times} × zählen</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item}: does not count without {needs}</source>
        <translation>{item}: zählt nicht ohne {needs}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item}: does not count with {other}</source>
        <translation>{item}: zählt nicht mit {other}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item}: {points} for the team, whichever attempt counts</source>
        <translation>{item}: {points} für das Team, gleich welcher Versuch zählt</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item}: 0 of {points}, because the robot did not complete the run</source>
        <translation>{item}: 0 von {points}, weil der Roboter den Lauf nicht abgeschlossen hat</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{why}: 0 of {points}</source>
        <translation>{why}: 0 von {points}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/scoring/tree.py"/>
        <source>{item}: {number} ×, but {other} only {times} ×</source>
        <translation>{item}: {number} ×, aber {other} nur {times} ×</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/standby/box_end.py"/>
        <source>the standby is not connected. It connects by itself: check that it runs, and its cable</source>
        <translation>Der Standby ist nicht verbunden. Er verbindet sich von selbst: Prüfen Sie, ob er läuft, und sein Kabel</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/standby/box_end.py"/>
        <source>no standby is connected since this computer took over. Enter &apos;standby rejoin&apos; on the computer that was the box, or pair another computer</source>
        <translation>Seit dieser Computer übernommen hat, ist kein Standby verbunden. Geben Sie auf dem Computer, der die Box war, &apos;standby rejoin&apos; ein, oder koppeln Sie einen anderen Computer</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/standby/box_end.py"/>
        <source>no standby is paired yet. Enter on the box: {command}</source>
        <translation>Es ist noch kein Standby gekoppelt. Geben Sie auf dem Computer der Box ein: {command}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/standby/box_end.py"/>
        <source>{why} ({error})</source>
        <translation>{why} ({error})</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/standby/box_end.py"/>
        <source>The standby is {standby} now, instead of {other}. If none of you paired it, a stranger has all results and passwords: pair your standby again, and give the teams new passwords</source>
        <translation>Der Standby ist jetzt {standby} statt {other}. Wenn niemand von Ihnen ihn gekoppelt hat, hat ein Fremder alle Ergebnisse und Passwörter: Koppeln Sie Ihren Standby erneut, und geben Sie den Teams neue Passwörter</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/standby/remote.py"/>
        <source>the standby reports: {why}</source>
        <translation>Der Standby meldet: {why}</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/standby/remote.py"/>
        <source>box and standby have different versions of roah_rsbb. Install the same one on both</source>
        <translation>Box und Standby haben verschiedene Versionen von roah_rsbb. Installieren Sie auf beiden dieselbe</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/standby/remote.py"/>
        <source>a STOP cannot be kept: {error}. Free or repair its disk</source>
        <translation>ein STOP kann nicht aufbewahrt werden: {error}. Schaffen Sie dort Platz, oder reparieren Sie die Festplatte</translation>
    </message>
    <message>
        <location filename="../../src/roah_rsbb/standby/remote.py"/>
        <source>the standby answers nonsense ({error}). Install the same version there</source>
        <translation>der Standby antwortet Unsinn ({error}). Installieren Sie dort dieselbe Version</translation>
    </message>
</context>
</TS>
