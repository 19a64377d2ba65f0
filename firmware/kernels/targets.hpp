// Which instruction sets the kernels are compiled for. To be included before <hwy/...>.
#pragma once

// On x86-64 the machine is asked at run time. On Arm Highway's question includes AES, which the Raspberry Pi 4
// lacks, and its NEON code would be compiled with it; every aarch64 has NEON, so it is taken without asking.
#if defined(__aarch64__) || defined(__arm__)
#define HWY_COMPILE_ONLY_STATIC
#define TOOLCHAIN_MISS_SYS_AUXV_H  // Highway's name for: no question, hence no "+crypto"
#endif
