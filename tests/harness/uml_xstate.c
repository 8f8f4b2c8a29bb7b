// Preloaded into User-Mode Linux on processors with AMX.
//
// User-Mode Linux 6.1 sets the extended registers of its processes (PTRACE_SETREGSET, NT_X86_XSTATE) from a buffer of 2,696 bytes. Where
// the processor has AMX, the host accepts nothing shorter than its whole state of some 11 KB, and User-Mode Linux ends before its init.
// So for this one request the whole state is read first, the caller's part is laid over it, and the whole is written back.
//
//     cc -shared -fPIC -O2 -o uml_xstate.so uml_xstate.c
#define _GNU_SOURCE
#include <elf.h>
#include <errno.h>
#include <stdarg.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

// Not on the stack: the caller's is that of an emulated kernel, 16 KB. That kernel has one processor, so nobody else is in here.
static char whole[32768] __attribute__((aligned(64)));

static long raw(long request, pid_t pid, void *address, void *data) {
    return syscall(SYS_ptrace, request, (long)pid, address, data);
}

long ptrace(enum __ptrace_request request, ...) {
    va_list arguments;
    va_start(arguments, request);
    pid_t pid = va_arg(arguments, pid_t);
    void *address = va_arg(arguments, void *);
    void *data = va_arg(arguments, void *);
    va_end(arguments);

    if (request == PTRACE_PEEKTEXT || request == PTRACE_PEEKDATA || request == PTRACE_PEEKUSER) {
        // The system call stores the word; the library's function returns it.
        long word = 0;
        if (raw(request, pid, address, &word) < 0) return -1;
        errno = 0;
        return word;
    }
    if (request == PTRACE_SETREGSET && (long)address == NT_X86_XSTATE) {
        struct iovec *given = data;
        struct iovec state = {whole, sizeof whole};
        if (raw(PTRACE_GETREGSET, pid, address, &state) == 0 && state.iov_len > given->iov_len) {
            memcpy(whole, given->iov_base, given->iov_len);
            return raw(PTRACE_SETREGSET, pid, address, &state);
        }
    }
    return raw(request, pid, address, data);
}
