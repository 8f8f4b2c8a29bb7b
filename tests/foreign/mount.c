/* A rubber mount as an FMU that is not ours, FMI 2.0 and 3.0 for co-simulation: what `oleo diagnose --fmu` is tried on.
 *
 *   force = stiffness x + viscous v + z,   dz/dt = relaxing_stiffness v - z / time_constant
 *
 * x and v are inputs; z is what it remembers. The parameter `misbehave` makes it do what foreign programs do.
 */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { X, V, FORCE, STIFFNESS, VISCOUS, RELAXING, TIME_CONSTANT, REALS };
enum { MISBEHAVE = 0 };
enum { WELL, HANGS, ABORTS, EXITS, FAILS, NOT_A_NUMBER, REMEMBERS, EATS };

typedef void (*logger2)(void *, const char *, int, const char *, const char *, ...);
typedef void (*logger3)(void *, int, const char *, const char *);
typedef struct {
    logger2 logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void *step_finished, *environment;
} callbacks2;

typedef struct {
    double real[REALS], z;
    int misbehave;
    const callbacks2 *callbacks;
    logger3 logger;
    void *environment;
} instance;

/* What survives from one instance to the next, which it should not. */
static double remembered = 0.0;

static instance *begin(void) {
    instance *self = calloc(1, sizeof *self);
    self->real[STIFFNESS] = 20000.0;
    self->real[VISCOUS] = 300.0;
    self->real[RELAXING] = 8000.0;
    self->real[TIME_CONSTANT] = 0.05;
    return self;
}

static void outputs(instance *self) {
    double *r = self->real;
    r[FORCE] = r[STIFFNESS] * r[X] + r[VISCOUS] * r[V] + self->z;
    if (self->misbehave == REMEMBERS) r[FORCE] += remembered;
}

static int step(instance *self, double time, double h) {
    double *r = self->real;
    if (time >= 1.0) switch (self->misbehave) {
        case HANGS: for (;;) {}
        case ABORTS: fprintf(stderr, "assertion failed: the mount is torn\n"); abort();
        case EXITS: exit(3);
        case EATS: for (;;) memset(malloc(1 << 24), 1, 1 << 24);
        case NOT_A_NUMBER: self->z = NAN; return 0;
        case FAILS:
            if (self->callbacks)
                self->callbacks->logger(NULL, "mount", 3, "error", "the solver does not converge at %g s", time);
            if (self->logger) self->logger(self->environment, 3, "error", "the solver does not converge");
            return 3;
        default: break;
    }
    /* Exact for a speed that is constant during the step. */
    double tau = r[TIME_CONSTANT], end = r[RELAXING] * r[V] * tau;
    self->z = end + (self->z - end) * exp(-h / tau);
    remembered += 1.0;
    return 0;
}

/* FMI 2.0 */
void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources, const callbacks2 *callbacks, int visible, int logging) {
    (void)name; (void)resources; (void)visible; (void)logging;
    if (type != 1 || strcmp(guid, "{mount}") != 0) return NULL;
    instance *self = begin();
    self->callbacks = callbacks;
    return self;
}
void fmi2FreeInstance(void *self) { free(self); }
int fmi2SetupExperiment(void *self, int d, double t, double start, int e, double stop) { (void)self; (void)d; (void)t; (void)start; (void)e; (void)stop; return 0; }
int fmi2EnterInitializationMode(void *self) { (void)self; return 0; }
int fmi2ExitInitializationMode(void *self) { (void)self; return 0; }
int fmi2Terminate(void *self) { (void)self; return 0; }
int fmi2SetReal(void *self, const uint32_t *vr, size_t n, const double *v) { for (size_t i = 0; i < n; i++) ((instance *)self)->real[vr[i]] = v[i]; return 0; }
int fmi2GetReal(void *self, const uint32_t *vr, size_t n, double *v) { outputs(self); for (size_t i = 0; i < n; i++) v[i] = ((instance *)self)->real[vr[i]]; return 0; }
int fmi2SetInteger(void *self, const uint32_t *vr, size_t n, const int *v) { (void)vr; if (n) ((instance *)self)->misbehave = v[0]; return 0; }
int fmi2DoStep(void *self, double time, double h, int no_return) { (void)no_return; return step(self, time, h); }

/* FMI 3.0 */
void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible, bool logging, bool events, bool early, const uint32_t *vr, size_t n, void *environment, logger3 logger, void *update) {
    (void)name; (void)resources; (void)visible; (void)logging; (void)vr; (void)update;
    if (events || early || n || strcmp(token, "{mount}") != 0) return NULL;
    instance *self = begin();
    self->logger = logger;
    self->environment = environment;
    return self;
}
void fmi3FreeInstance(void *self) { free(self); }
int fmi3EnterInitializationMode(void *self, bool d, double t, double start, bool e, double stop) { (void)self; (void)d; (void)t; (void)start; (void)e; (void)stop; return 0; }
int fmi3ExitInitializationMode(void *self) { (void)self; return 0; }
int fmi3Terminate(void *self) { (void)self; return 0; }
int fmi3SetFloat64(void *self, const uint32_t *vr, size_t n, const double *v, size_t m) { (void)m; return fmi2SetReal(self, vr, n, v); }
int fmi3GetFloat64(void *self, const uint32_t *vr, size_t n, double *v, size_t m) { (void)m; return fmi2GetReal(self, vr, n, v); }
int fmi3SetInt32(void *self, const uint32_t *vr, size_t n, const int32_t *v, size_t m) { (void)m; return fmi2SetInteger(self, vr, n, v); }
int fmi3DoStep(void *self, double time, double h, bool no_return, bool *event, bool *terminate, bool *early, double *last) {
    (void)no_return;
    *event = *terminate = *early = false;
    *last = time + h;
    return step(self, time, h);
}
