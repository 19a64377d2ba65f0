// Which instruction sets the kernels are compiled for. To be included before <hwy/...>.
#pragma once

// On Arm Highway's run-time choice wants AES of a NEON machine, which the Raspberry Pi 4 lacks: there
// NEON, which every aarch64 has, is taken as it is. On x86-64 the machine is asked.
#if defined(__aarch64__) || defined(__arm__)
#define HWY_COMPILE_ONLY_STATIC
#endif
