// What the static program does itself rather than by the C library that is linked into it, with the same results: copying and filling
// memory, which that library does by one instruction that takes some thirty cycles to start, where most copies are of a few numbers; and
// the multiply-add, which it computes bit by bit even where the processor has one. `.ci/release` links this by `--wrap`.
//
// Only for x86-64, and only with -ffreestanding -fno-builtin -fno-tree-loop-distribute-patterns: a compiler would otherwise turn these loops
// into calls of what they are.
#include <cpuid.h>
#include <stddef.h>

typedef unsigned char byte;
typedef long long vector __attribute__((vector_size(16), aligned(1), may_alias));
typedef unsigned long long eight __attribute__((aligned(1), may_alias));
typedef unsigned four __attribute__((aligned(1), may_alias));

// Above this, the one instruction is the faster way.
enum { LONG = 4096 };

static inline vector load(const byte *from) { return *(const vector *)from; }
static inline void store(byte *to, vector value) { *(vector *)to = value; }

// At most 64 bytes, as pieces that may overlap: all is read before anything is written.
static inline void move_few(byte *to, const byte *from, size_t n) {
  if (n > 32) {
    vector a = load(from), b = load(from + 16), c = load(from + n - 32), d = load(from + n - 16);
    store(to, a), store(to + 16, b), store(to + n - 32, c), store(to + n - 16, d);
  } else if (n >= 16) {
    vector a = load(from), b = load(from + n - 16);
    store(to, a), store(to + n - 16, b);
  } else if (n >= 8) {
    unsigned long long a = *(const eight *)from, b = *(const eight *)(from + n - 8);
    *(eight *)to = a, *(eight *)(to + n - 8) = b;
  } else if (n >= 4) {
    unsigned a = *(const four *)from, b = *(const four *)(from + n - 4);
    *(four *)to = a, *(four *)(to + n - 4) = b;
  } else if (n > 0) {
    byte a = from[0], b = from[n / 2], c = from[n - 1];
    to[0] = a, to[n / 2] = b, to[n - 1] = c;
  }
}

void *__wrap_memmove(void *whither, const void *whence, size_t n) {
  byte *to = whither;
  const byte *from = whence;
  if (n <= 64) {
    move_few(to, from, n);
  } else if ((size_t)to - (size_t)from >= n) {
    // Forwards is safe. The last 64 bytes are read first, since the loop may overwrite them.
    vector a = load(from + n - 64), b = load(from + n - 48), c = load(from + n - 32), d = load(from + n - 16);
    byte *last = to + n - 64;
    if (n >= LONG) {
      byte *at = to;
      size_t left = n - 64;
      __asm__ volatile("rep movsb" : "+D"(at), "+S"(from), "+c"(left) : : "memory");
    } else {
      for (; to < last; to += 64, from += 64) {
        vector e = load(from), f = load(from + 16), g = load(from + 32), h = load(from + 48);
        store(to, e), store(to + 16, f), store(to + 32, g), store(to + 48, h);
      }
    }
    store(last, a), store(last + 16, b), store(last + 32, c), store(last + 48, d);
  } else {
    vector a = load(from), b = load(from + 16), c = load(from + 32), d = load(from + 48);
    for (size_t left = n; left > 64; left -= 64) {
      vector e = load(from + left - 64), f = load(from + left - 48), g = load(from + left - 32), h = load(from + left - 16);
      byte *at = to + left - 64;
      store(at, e), store(at + 16, f), store(at + 32, g), store(at + 48, h);
    }
    store(to, a), store(to + 16, b), store(to + 32, c), store(to + 48, d);
  }
  return whither;
}

void *__wrap_memcpy(void *restrict to, const void *restrict from, size_t n) { return __wrap_memmove(to, from, n); }

void *__wrap_memset(void *whither, int value, size_t n) {
  byte *to = whither;
  unsigned long long eightfold = 0x0101010101010101ULL * (byte)value;
  if (n >= LONG) {
    size_t left = n;
    __asm__ volatile("rep stosb" : "+D"(to), "+c"(left) : "a"(value) : "memory");
  } else if (n >= 16) {
    vector all = {(long long)eightfold, (long long)eightfold};
    for (size_t i = 0; i < n - 16; i += 16) store(to + i, all);
    store(to + n - 16, all);
  } else if (n >= 8) {
    *(eight *)to = eightfold, *(eight *)(to + n - 8) = eightfold;
  } else if (n >= 4) {
    *(four *)to = (unsigned)eightfold, *(four *)(to + n - 4) = (unsigned)eightfold;
  } else if (n > 0) {
    to[0] = to[n / 2] = to[n - 1] = (byte)value;
  }
  return whither;
}

double __real_fma(double x, double y, double z);

__attribute__((target("fma"))) static double fma_of_processor(double x, double y, double z) { return __builtin_fma(x, y, z); }

// Whether the processor has a multiply-add and the system keeps the registers that it needs.
static int has_fma(void) {
  unsigned a, b, c, d, low, high;
  if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_FMA) || !(c & bit_OSXSAVE) || !(c & bit_AVX)) return 0;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return (low & 6) == 6;
}

double __wrap_fma(double x, double y, double z) {
  // Asked once; threads that ask at the same time find the same.
  static int known;
  int now = __atomic_load_n(&known, __ATOMIC_RELAXED);
  if (__builtin_expect(!now, 0)) {
    now = 1 + has_fma();
    __atomic_store_n(&known, now, __ATOMIC_RELAXED);
  }
  return now == 2 ? fma_of_processor(x, y, z) : __real_fma(x, y, z);
}
