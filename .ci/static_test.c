// Does what `.ci/static.c` does give the same as the C library of the machine: all lengths to 300 and some to 8,000 bytes, at all distances
// to 70 and some to 200, overlapping either way; and ten million multiply-adds over many sizes. Exits with 1 if not.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *__wrap_memcpy(void *, const void *, size_t);
void *__wrap_memmove(void *, const void *, size_t);
void *__wrap_memset(void *, int, size_t);
double __wrap_fma(double, double, double);
// Never right, so that a processor with a multiply-add that is not asked is noticed.
double __real_fma(double x, double y, double z) {
  return __builtin_cpu_supports("fma") ? NAN : fma(x, y, z);
}

enum { SIZE = 10000 };
static unsigned char ours[SIZE], theirs[SIZE];

static size_t next(size_t k, size_t dense) { return k < dense ? k + 1 : k * 5 / 4; }

int main(void) {
  size_t wrong = 0, cases = 0;
  for (size_t n = 0; n < 8000; n = next(n, 300)) {
    for (size_t from = 0; from < 200; from = next(from, 70)) {
      for (size_t to = 0; to < 200; to = next(to, 70), cases++) {
        for (size_t i = 0; i < SIZE; i++) ours[i] = theirs[i] = (unsigned char)(i * 31 + (i >> 8));
        memmove(theirs + to, theirs + from, n);
        wrong += __wrap_memmove(ours + to, ours + from, n) != ours + to || memcmp(ours, theirs, SIZE) != 0;
        if (to + n <= from || from + n <= to) {
          __wrap_memcpy(ours + to, theirs + from, n), memcpy(theirs + to, theirs + from, n);
          wrong += memcmp(ours, theirs, SIZE) != 0;
        }
        if (from < 3) {
          memset(theirs + to, (int)from * 77, n);
          wrong += __wrap_memset(ours + to, (int)from * 77, n) != ours + to || memcmp(ours, theirs, SIZE) != 0;
        }
      }
    }
  }
  for (int k = 0; k < 10000000; k++, cases++) {
    double x = ldexp(drand48() - 0.5, (int)(lrand48() % 40) - 20), y = drand48() - 0.5, z = ldexp(drand48() - 0.5, (int)(lrand48() % 120) - 90);
    wrong += __wrap_fma(x, y, z) != fma(x, y, z);
  }
  printf("%zu of %zu are wrong\n", wrong, cases);
  return wrong > 0;
}
