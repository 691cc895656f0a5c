"""Takes away from the modules of the package what Python does not have on Windows. Other modules keep it: the standard
library of this system needs it."""

import builtins
import errno
import fcntl
import os
import sys
import types

MODULES = ("fcntl", "resource", "pwd", "grp", "termios", "tty", "pty", "curses", "readline", "syslog")
# Those that the Python of this system does not have, either, are no mistake.
NAMES = {
    "os": """O_ASYNC O_CLOEXEC O_DIRECT O_DIRECTORY O_DSYNC O_NOATIME O_NOCTTY O_NOFOLLOW O_NONBLOCK O_PATH O_RSYNC
        O_SYNC O_TMPFILE WNOHANG WIFEXITED WEXITSTATUS WIFSIGNALED WTERMSIG chown chroot ctermid eventfd fchdir fchmod
        fchown fdatasync fork forkpty fstatvfs getegid geteuid getgid getgroups getloadavg getpgid getpgrp getpriority
        getresuid getsid getuid getxattr killpg lchown listxattr lockf memfd_create mkfifo mknod nice openpty pidfd_open
        pipe2 posix_fadvise posix_fallocate posix_spawn pread preadv pwrite pwritev readv register_at_fork removexattr
        sched_getaffinity sched_setaffinity sched_yield sendfile setegid seteuid setgid setpgid setpriority setsid
        setuid setxattr statvfs sync sysconf tcgetpgrp tcsetpgrp ttyname uname wait wait3 wait4 waitid writev""",
    "select": "poll epoll",
    "signal": """SIGALRM SIGBUS SIGCHLD SIGCONT SIGHUP SIGIO SIGKILL SIGPIPE SIGPOLL SIGPROF SIGPWR SIGQUIT SIGSTOP
        SIGSYS SIGTRAP SIGTSTP SIGTTIN SIGTTOU SIGURG SIGUSR1 SIGUSR2 SIGVTALRM SIGWINCH SIGXCPU SIGXFSZ alarm getitimer
        pause pthread_kill pthread_sigmask setitimer siginterrupt sigpending sigtimedwait sigwait sigwaitinfo""",
    "socket": """AF_NETLINK AF_PACKET AF_UNIX CMSG_LEN CMSG_SPACE MSG_CMSG_CLOEXEC MSG_DONTWAIT MSG_MORE MSG_NOSIGNAL
        SCM_CREDENTIALS SCM_RIGHTS SOCK_CLOEXEC SOCK_NONBLOCK SO_BINDTODEVICE SO_DOMAIN SO_MARK SO_PASSCRED SO_PEERCRED
        SO_PRIORITY SO_PROTOCOL SO_REUSEPORT TCP_CORK TCP_DEFER_ACCEPT TCP_INFO TCP_QUICKACK TCP_USER_TIMEOUT
        sethostname""",
    "time": """CLOCK_BOOTTIME CLOCK_MONOTONIC CLOCK_MONOTONIC_RAW CLOCK_PROCESS_CPUTIME_ID CLOCK_REALTIME
        CLOCK_THREAD_CPUTIME_ID clock_getres clock_gettime clock_settime pthread_getcpuclockid tzset""",
}


class _Lacking(types.ModuleType):
    """A module without some of its names."""

    def __init__(self, module, names):
        super().__init__(module.__name__)
        self.__dict__["_module"], self.__dict__["_names"] = module, names.split()

    def __getattr__(self, name):
        if name in self._names:
            raise AttributeError(f"on Windows, module '{self.__name__}' has no attribute '{name}'")
        return getattr(self._module, name)


class WindowsFiles:
    """Stands for the modules of Windows that open and lock files, `_winapi` and `msvcrt`."""

    LK_NBLCK = 2

    def __init__(self):
        self.locked = []  # places in files

    def CreateFile(self, path, access, share, security, how, attributes, template):
        """Open a file; returns its handle."""
        assert (share, security, template) == (7, 0, 0), "the file cannot be renamed while it is open"
        creating = {1: os.O_CREAT | os.O_EXCL, 2: os.O_CREAT | os.O_TRUNC, 3: 0, 4: os.O_CREAT, 5: os.O_TRUNC}[how]
        reading = {0x80000000: os.O_RDONLY, 0x40000000: os.O_WRONLY, 0xC0000000: os.O_RDWR}[access]
        return os.open(path, reading | creating, 0o666)

    def open_osfhandle(self, handle, flags):
        """Return the descriptor of a handle."""
        assert flags in (0, os.O_APPEND)
        if flags:
            fcntl.fcntl(handle, fcntl.F_SETFL, os.O_APPEND)
        return handle

    def locking(self, fd, how, count):
        """Lock bytes from the position of a file on."""
        assert (how, count) == (self.LK_NBLCK, 1)
        self.locked.append(os.lseek(fd, 0, os.SEEK_CUR))
        try:
            fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise PermissionError(errno.EACCES, "Permission denied") from None


def take_away():
    """Take everything away from the modules of the package that are imported from now on."""
    real, lacking = builtins.__import__, {}

    def import_(name, globals=None, locals=None, fromlist=(), level=0):
        """As `__import__`."""
        top = name.partition(".")[0]
        if level == 0 and str((globals or {}).get("__name__", "")).partition(".")[0] == "roah_rsbb":
            if top in MODULES:
                raise ModuleNotFoundError(f"Windows has no module {name}", name=name)
            if name in NAMES:
                if name not in lacking:
                    lacking[name] = _Lacking(real(name), NAMES[name])
                return lacking[name]
        return real(name, globals, locals, fromlist, level)

    assert "roah_rsbb.platform" not in sys.modules, "it has what it shall find missing"
    builtins.__import__ = import_
    from roah_rsbb import platform

    platform.WINDOWS, platform.fcntl = True, None
    platform.msvcrt = platform._winapi = WindowsFiles()
