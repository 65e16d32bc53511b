/* Internal: says what to install if there is no device. */
#ifndef TD_ADVICE_H
#define TD_ADVICE_H

/* The file that describes the operating system, by os-release(5). */
#define TD_OS_RELEASE "/etc/os-release"

/* A CPU driver from PyPI, under the names that the Python package looks for. It exists for x86-64 only. */
#ifdef __x86_64__
#define TD_ADVICE_PIP ", or for Python: pip install intel-opencl-rt intel-cmplr-lib-rt"
#else
#define TD_ADVICE_PIP ""
#endif

/* The command that installs a CPU driver on the system that `os_release` describes; a description if the system is unknown. */
const char *td_device_advice(const char *os_release);

#endif
