/* Internal: what to install where there is no device. */
#ifndef TD_ADVICE_H
#define TD_ADVICE_H

/* os-release(5): what the system says of itself. */
#define TD_OS_RELEASE "/etc/os-release"

/* A CPU device from PyPI, by the names that the Python package looks for; it is for x86-64 alone. */
#ifdef __x86_64__
#define TD_ADVICE_PIP ", or for Python: pip install intel-opencl-rt intel-cmplr-lib-rt"
#else
#define TD_ADVICE_PIP ""
#endif

/* The command that installs a CPU device on the system of the file `os_release`; a description where that isn't known. */
const char *td_device_advice(const char *os_release);

#endif
