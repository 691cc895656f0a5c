/* Records what a program that preloads this does to the files in RECORDED_FOLDER, in the order in which the system did
 * it, in the file RECORDED_LOG (recorded_writes.py reads it). fsync leaves two records: what was written before the
 * first is on the disk at the second. With RECORDED_FAIL=N, the N-th fsync in each process fails and RECORDED_FAIL_NAME
 * must be the end of the file's name. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

struct __attribute__((packed)) record { char kind; uint64_t inode; int64_t at; uint32_t thread, length; };

static pthread_mutex_t order = PTHREAD_MUTEX_INITIALIZER;
static int log_fd = -1, fail_at;
static const char *folder, *fail_name;

__attribute__((constructor)) static void begin(void) {
  folder = getenv("RECORDED_FOLDER");
  fail_name = getenv("RECORDED_FAIL_NAME");
  fail_at = getenv("RECORDED_FAIL") ? atoi(getenv("RECORDED_FAIL")) : 0;
  if (folder) log_fd = syscall(SYS_openat, AT_FDCWD, getenv("RECORDED_LOG"), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
}

static int is_inside(const char *path) {
  size_t length = folder ? strlen(folder) : 0;
  return length && !strncmp(path, folder, length) && (path[length] == '/' || !path[length]);
}

/* The path of a file descriptor in the folder; 0: another file. */
static const char *path_of(int fd, char *path) {
  char link[40];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  ssize_t length = folder ? readlink(link, path, 4095) : -1;
  if (length < 0) return 0;
  path[length] = 0;
  return is_inside(path) ? path : 0;
}

static void say(char kind, uint64_t inode, int64_t at, const void *data, size_t length) {
  struct record head = {kind, inode, at, syscall(SYS_gettid), length};
  if (syscall(SYS_write, log_fd, &head, sizeof head) != sizeof head
      || (length && syscall(SYS_write, log_fd, data, length) != (ssize_t)length)) abort();
}

static uint64_t inode_of(int fd) { struct stat s; return fstat(fd, &s) ? 0 : s.st_ino; }

/* Something that a test wants to know the place of, such as an acknowledgement. */
void recorded_mark(const char *text) {
  pthread_mutex_lock(&order);
  say('a', 0, 0, text, strlen(text));
  pthread_mutex_unlock(&order);
}

/* The process is killed between two operations, so that the record has all of them. */
void recorded_kill(void) { pthread_mutex_lock(&order); kill(getpid(), SIGKILL); pause(); }

static int opened(int at, const char *path, int flags, mode_t mode) {
  char absolute[4096], folder_path[4096], *real = realpath(".", folder_path);
  if (!folder || !(flags & (O_CREAT | O_TRUNC))) return syscall(SYS_openat, at, path, flags, mode);
  if (path[0] == '/') snprintf(absolute, sizeof absolute, "%s", path);
  else snprintf(absolute, sizeof absolute, "%s/%s", real ? real : "", path);
  if (!is_inside(absolute)) return syscall(SYS_openat, at, path, flags, mode);
  pthread_mutex_lock(&order);
  struct stat s;
  int is_new = stat(absolute, &s) != 0;
  int fd = syscall(SYS_openat, at, path, flags, mode), error = errno;
  if (fd >= 0 && is_new) say('c', inode_of(fd), 0, absolute, strlen(absolute));
  if (fd >= 0 && !is_new && flags & O_TRUNC) say('t', inode_of(fd), 0, 0, 0);
  pthread_mutex_unlock(&order);
  errno = error;
  return fd;
}

#define MODE mode_t mode = 0; if (flags & (O_CREAT | __O_TMPFILE)) { va_list list; va_start(list, flags); mode = va_arg(list, mode_t); va_end(list); }
int open(const char *path, int flags, ...) { MODE return opened(AT_FDCWD, path, flags, mode); }
int open64(const char *path, int flags, ...) { MODE return opened(AT_FDCWD, path, flags | O_LARGEFILE, mode); }
int openat(int at, const char *path, int flags, ...) { MODE return opened(at, path, flags, mode); }
int openat64(int at, const char *path, int flags, ...) { MODE return opened(at, path, flags | O_LARGEFILE, mode); }

static ssize_t written(int fd, const void *data, size_t length, off64_t at, int is_here) {
  char path[4096];
  if (!path_of(fd, path)) return is_here ? syscall(SYS_write, fd, data, length) : syscall(SYS_pwrite64, fd, data, length, at);
  pthread_mutex_lock(&order);
  if (is_here) at = fcntl(fd, F_GETFL) & O_APPEND ? lseek64(fd, 0, SEEK_END) : lseek64(fd, 0, SEEK_CUR);
  ssize_t done = is_here ? syscall(SYS_write, fd, data, length) : syscall(SYS_pwrite64, fd, data, length, at);
  int error = errno;
  if (done > 0) say('w', inode_of(fd), at, data, done);
  pthread_mutex_unlock(&order);
  errno = error;
  return done;
}
ssize_t write(int fd, const void *data, size_t length) { return written(fd, data, length, 0, 1); }
ssize_t pwrite(int fd, const void *data, size_t length, off_t at) { return written(fd, data, length, at, 0); }
ssize_t pwrite64(int fd, const void *data, size_t length, off64_t at) { return written(fd, data, length, at, 0); }

static int resized(int fd, off64_t size) {
  char path[4096];
  if (!path_of(fd, path)) return syscall(SYS_ftruncate, fd, size);
  pthread_mutex_lock(&order);
  int failed = syscall(SYS_ftruncate, fd, size), error = errno;
  if (!failed) say('t', inode_of(fd), size, 0, 0);
  pthread_mutex_unlock(&order);
  errno = error;
  return failed;
}
int ftruncate(int fd, off_t size) { return resized(fd, size); }
int ftruncate64(int fd, off64_t size) { return resized(fd, size); }

static int enlarged(int fd, off64_t at, off64_t length) {
  struct stat s;
  return fstat(fd, &s) ? errno : s.st_size >= at + length ? 0 : resized(fd, at + length) ? errno : 0;
}
int posix_fallocate(int fd, off_t at, off_t length) { return enlarged(fd, at, length); }
int posix_fallocate64(int fd, off64_t at, off64_t length) { return enlarged(fd, at, length); }

static int synced(int fd, long number) {
  char path[4096];
  if (!path_of(fd, path)) return syscall(number, fd);
  uint64_t inode = inode_of(fd);
  size_t length = strlen(path), end = fail_name ? strlen(fail_name) : 0;
  pthread_mutex_lock(&order);
  int fails = end && length >= end && !strcmp(path + length - end, fail_name) && --fail_at == 0;
  say('F', inode, 0, path, length);
  pthread_mutex_unlock(&order);
  int failed = fails ? -1 : syscall(number, fd), error = fails ? EIO : errno;
  pthread_mutex_lock(&order);
  say(failed ? 'x' : 'f', inode, 0, 0, 0);
  pthread_mutex_unlock(&order);
  errno = error;
  return failed;
}
int fsync(int fd) { return synced(fd, SYS_fsync); }
int fdatasync(int fd) { return synced(fd, SYS_fdatasync); }

static void say_two(char kind, uint64_t inode, const char *from, const char *to) {
  char both[8192];
  int length = snprintf(both, sizeof both, "%s%c%s", from, 0, to);
  say(kind, inode, 0, both, length);
}

static int renamed(int from_at, const char *from, int to_at, const char *to) {
  pthread_mutex_lock(&order);
  int failed = syscall(SYS_renameat, from_at, from, to_at, to), error = errno;
  if (!failed && is_inside(to)) say_two('r', 0, from, to);
  pthread_mutex_unlock(&order);
  errno = error;
  return failed;
}
int rename(const char *from, const char *to) { return renamed(AT_FDCWD, from, AT_FDCWD, to); }
int renameat(int from_at, const char *from, int to_at, const char *to) { return renamed(from_at, from, to_at, to); }

static int made(int at, const char *path, mode_t mode) {
  pthread_mutex_lock(&order);
  struct stat s;
  int failed = syscall(SYS_mkdirat, at, path, mode), error = errno;
  if (!failed && is_inside(path) && !stat(path, &s)) say('d', s.st_ino, 0, path, strlen(path));
  pthread_mutex_unlock(&order);
  errno = error;
  return failed;
}
int mkdir(const char *path, mode_t mode) { return made(AT_FDCWD, path, mode); }
int mkdirat(int at, const char *path, mode_t mode) { return made(at, path, mode); }

static int linked(int from_at, const char *from, int to_at, const char *to, int flags) {
  pthread_mutex_lock(&order);
  struct stat s;
  int failed = syscall(SYS_linkat, from_at, from, to_at, to, flags), error = errno;
  if (!failed && is_inside(to) && !stat(to, &s)) say('c', s.st_ino, 0, to, strlen(to));
  pthread_mutex_unlock(&order);
  errno = error;
  return failed;
}
int link(const char *from, const char *to) { return linked(AT_FDCWD, from, AT_FDCWD, to, 0); }
int linkat(int from_at, const char *from, int to_at, const char *to, int flags) { return linked(from_at, from, to_at, to, flags); }

static int removed(int at, const char *path, int flags) {
  pthread_mutex_lock(&order);
  int failed = syscall(SYS_unlinkat, at, path, flags), error = errno;
  if (!failed && is_inside(path)) say('u', 0, 0, path, strlen(path));
  pthread_mutex_unlock(&order);
  errno = error;
  return failed;
}
int unlink(const char *path) { return removed(AT_FDCWD, path, 0); }
int unlinkat(int at, const char *path, int flags) { return removed(at, path, flags); }
int remove(const char *path) { return removed(AT_FDCWD, path, 0); }
