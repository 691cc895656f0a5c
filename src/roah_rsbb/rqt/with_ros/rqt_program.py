"""rqt with our panels, as launch files start it (`gui.py`)."""

from typing import Any, NoReturn

from roah_rsbb.rqt.app.application import end_at_signals, grow, leave
from roah_rsbb.rqt.qt import QApplication, QMainWindow
from roah_rsbb.rqt.with_ros.node import WindowNode


def run_rqt(main: Any) -> NoReturn:
    """Run rqt, given its `rqt_gui.main.Main`. A signal or its closed window ends the process, also during its start.

    qt_gui crashes or hangs if it closes its window while it loads a panel, and sometimes crashes afterwards. So the
    process ends before qt_gui closes its window. This loses nothing: rqt's settings are cleared at each start.
    """
    host = WindowNode()
    create, add_providers = main.create_application, main._add_plugin_providers

    def add_plugin_providers() -> None:
        window = next(widget for widget in QApplication.topLevelWidgets() if isinstance(widget, QMainWindow))
        window.save_settings_before_close_signal.connect(lambda *_: leave(host, 0))
        add_providers()

    main.create_application, main._add_plugin_providers = lambda argv: grow(create(argv)), add_plugin_providers
    end_at_signals(host, 0.0)
    leave(host, main.main())
