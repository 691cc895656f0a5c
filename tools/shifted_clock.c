/* Shifts the clock of the day by CLOCK_OFFSET_S seconds in a program that preloads this; durations stay as they are. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <semaphore.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
static long offset(void) { const char *s = getenv("CLOCK_OFFSET_S"); return s ? atol(s) : 0; }
int clock_gettime(clockid_t id, struct timespec *t) {
  int r = syscall(SYS_clock_gettime, id, t);
  if (!r && (id == CLOCK_REALTIME || id == CLOCK_REALTIME_COARSE)) t->tv_sec += offset();
  return r;
}
int gettimeofday(struct timeval *restrict v, void *restrict z) {
  struct timespec t; clock_gettime(CLOCK_REALTIME, &t); v->tv_sec = t.tv_sec; v->tv_usec = t.tv_nsec / 1000; return 0;
}
time_t time(time_t *p) { struct timespec t; clock_gettime(CLOCK_REALTIME, &t); if (p) *p = t.tv_sec; return t.tv_sec; }
/* Python 3.8 waits until a time of the day. The system's clock is not shifted. */
int sem_timedwait(sem_t *restrict semaphore, const struct timespec *restrict until) {
  static int (*system_wait)(sem_t *, const struct timespec *);
  if (!system_wait) *(void **)&system_wait = dlsym(RTLD_NEXT, "sem_timedwait");
  struct timespec real = *until;
  real.tv_sec -= offset();
  return system_wait(semaphore, &real);
}
