// A bug in this program: always on, in every build. Trouble from outside is a Result (result.hpp);
// "no answer yet" is an ordinary value with a status.
#pragma once

#include <cstdio>
#include <cstdlib>

#define RFMVO_ASSERT(condition)                                                             \
  do {                                                                                      \
    if (!(condition)) {                                                                     \
      std::fprintf(stderr, "%s:%d: assertion failed: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                         \
    }                                                                                       \
  } while (false)
