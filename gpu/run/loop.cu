/* SPDX-License-Identifier: Apache-2.0 */
/* Captures and keeps CUDA graphs, with a WHILE node for loops. In a build
 * without CUDA gpu/run/emulate_threads.cpp takes its place. gpu/run/loop.cuh */
#include "gpu/run/loop.cuh"

/* At most LOOPS graphs are kept. The least recently used one may go when
 * LOOP_IDLE launches have passed since it was used. */
enum { LOOPS = 64, LOOP_IDLE = 4096 };

/* A graph that is kept. Its key follows it in memory. */
struct kept {
    struct kept *next;
    cudaGraphExec_t graph;
    size_t n;
    int block, ranks;
    int64_t used; /* number of its last launch */
    int status;   /* what the captured parts returned */
};

struct gpu_loops {
    cudaStream_t stream; /* for captures: the caller's may not allow them */
    struct kept *first;
    int count;
    bool absent; /* the device has no such graphs */
    int64_t launches;
};

#if CUDART_VERSION >= 12030

static __global__ void loop_kernel(cudaGraphConditionalHandle handle,
                                   const int32_t *again)
{
    cudaGraphSetConditional(handle, *again != 0);
}

/* A WHILE node: its body, which is empty at first, and the handle that says
 * whether the body runs once more. */
struct while_node {
    cudaGraphNode_t node;
    cudaGraph_t body;
    cudaGraphConditionalHandle handle;
};

static cudaError_t add_while(cudaGraph_t graph, struct while_node *w)
{
    cudaGraphNodeParams p = {};
    cudaError_t error =
        cudaGraphConditionalHandleCreate(&w->handle, graph, 0, 0);
    if (error != cudaSuccess)
        return error;
    p.type = cudaGraphNodeTypeConditional;
    p.conditional.handle = w->handle;
    p.conditional.type = cudaGraphCondTypeWhile;
    p.conditional.size = 1;
#if CUDART_VERSION >= 13000
    error = cudaGraphAddNode(&w->node, graph, NULL, NULL, 0, &p);
#else
    error = cudaGraphAddNode(&w->node, graph, NULL, 0, &p);
#endif
    if (error == cudaSuccess)
        w->body = p.conditional.phGraph_out[0];
    return error;
}

/* Makes the node wait for what the stream has captured so far. */
static cudaError_t put_after(cudaStream_t stream, struct while_node *w)
{
    cudaStreamCaptureStatus status;
    const cudaGraphNode_t *last;
    cudaGraph_t graph;
    size_t n;
#if CUDART_VERSION >= 13000
    cudaError_t error = cudaStreamGetCaptureInfo(stream, &status, NULL, &graph,
                                                 &last, NULL, &n);
#else
    cudaError_t error =
        cudaStreamGetCaptureInfo(stream, &status, NULL, &graph, &last, &n);
#endif
    for (size_t k = 0; k < n && error == cudaSuccess; k++)
#if CUDART_VERSION >= 13000
        error = cudaGraphAddDependencies(graph, &last[k], &w->node, NULL, 1);
#else
        error = cudaGraphAddDependencies(graph, &last[k], &w->node, 1);
#endif
    return error;
}

/* Captures the launches of a part into the graph, after a node unless that is
 * NULL. A failure of the capture is not a failure of the device. */
static cudaError_t capture(struct gpu *g, cudaGraph_t graph,
                           const cudaGraphNode_t *after, loop_part part,
                           int *status)
{
    cudaStream_t stream = g->loops->stream, callers = g->stream;
    size_t n = strlen(g->name);
    cudaError_t error =
        cudaStreamBeginCaptureToGraph(stream, graph, after, NULL, after != NULL,
                                      cudaStreamCaptureModeRelaxed);
    if (error != cudaSuccess)
        return error;
    g->stream = stream;
    *status = part.run(part.with);
    g->stream = callers;
    error = cudaStreamEndCapture(stream, &graph);
    if (g->failed) {
        *status = g->failed = DRAPE_OK;
        g->name[n] = 0;
        return cudaErrorUnknown;
    }
    return *status == DRAPE_OK ? error : cudaErrorInvalidValue;
}

/* The body is captured first, as branches must not be captured within another
 * capture. */
static cudaError_t capture_loop(struct gpu *g, cudaGraph_t graph,
                                const struct loop *of, int *status)
{
    struct while_node w;
    cudaError_t error = add_while(graph, &w), tied = cudaSuccess;
    auto test = [&] {
        loop_kernel<<<1, 1, 0, g->stream>>>(w.handle, of->again);
    };
    auto body = [&] {
        int done = of->body.run(of->body.with);
        test();
        return done;
    };
    auto first = [&] {
        int done = of->first.run(of->first.with);
        test();
        tied = put_after(g->stream, &w);
        return done;
    };
    if (error == cudaSuccess)
        error = capture(g, w.body, NULL, body, status);
    if (error == cudaSuccess)
        error = capture(g, graph, NULL, first, status);
    if (error == cudaSuccess && tied == cudaSuccess)
        error = capture(g, graph, &w.node, of->last, status);
    return tied == cudaSuccess ? error : tied;
}

/* Captures and instantiates the graph of k, and sets k's graph and status. */
static cudaError_t build(struct gpu *g, struct kept *k, const struct loop *of)
{
    cudaGraph_t graph;
    cudaError_t error = cudaGraphCreate(&graph, 0);
    if (error != cudaSuccess)
        return error;
    error = of->again ? capture_loop(g, graph, of, &k->status)
                      : capture(g, graph, NULL, of->first, &k->status);
    if (error == cudaSuccess)
        error = cudaGraphInstantiate(&k->graph, graph, 0);
    cudaGraphDestroy(graph);
    return error;
}

#else

static cudaError_t build(struct gpu *, struct kept *, const struct loop *)
{
    return cudaErrorNotSupported;
}

#endif

static bool same(const struct kept *k, const struct gpu *g, struct loop_key key)
{
    return k->block == g->block && k->ranks == g->ranks && k->n == key.n &&
           !memcmp(k + 1, key.bytes, key.n);
}

/* Makes room for one more graph. False if all kept graphs were used recently.
 */
static bool make_room(struct gpu *g)
{
    struct gpu_loops *l = g->loops;
    struct kept **oldest = &l->first;
    if (l->count < LOOPS)
        return true;
    for (struct kept **at = &l->first; *at; at = &(*at)->next)
        if ((*at)->used < (*oldest)->used)
            oldest = at;
    struct kept *k = *oldest;
    if (k->used + LOOP_IDLE > l->launches)
        return false;
    *oldest = k->next;
    gpu_wait(g);
    cudaGraphExecDestroy(k->graph);
    arena_give(&g->host, k);
    l->count--;
    return true;
}

/* Captures a new graph and keeps it. NULL if that is not possible. */
static struct kept *make(struct gpu *g, struct loop_key key,
                         const struct loop *of)
{
    struct gpu_loops *l = g->loops;
    struct kept *k = NULL;
    if (make_room(g))
        k = (struct kept *)arena_take(&g->host, ARENA_OTHER,
                                      (int64_t)(sizeof *k + key.n), 1);
    if (!k)
        return NULL;
    cudaError_t error = build(g, k, of);
    if (error != cudaSuccess) {
        cudaGetLastError(); /* forget the error: it means that there are none */
        l->absent = k->status == DRAPE_OK && error != cudaErrorMemoryAllocation;
        arena_give(&g->host, k);
        return NULL;
    }
    k->n = key.n;
    k->block = g->block;
    k->ranks = g->ranks;
    memcpy(k + 1, key.bytes, key.n);
    k->next = l->first;
    l->first = k;
    l->count++;
    return k;
}

static bool open_loops(struct gpu *g)
{
    if (!g->loops)
        g->loops = (struct gpu_loops *)arena_take(&g->host, ARENA_OTHER, 1,
                                                  sizeof *g->loops);
    if (!g->loops || g->loops->absent)
        return false;
    if (!g->loops->stream)
        gpu_note(g, cudaStreamCreateWithFlags(&g->loops->stream,
                                              cudaStreamNonBlocking));
    return !g->failed;
}

bool gpu_loop(struct gpu *g, struct loop_key key, const struct loop &of)
{
    if (g->hosted[0] || g->hosted[1] || g->together || g->failed ||
        !open_loops(g))
        return false;
    struct kept *k = g->loops->first;
    while (k && !same(k, g, key))
        k = k->next;
    if (!k)
        k = make(g, key, &of);
    if (!k)
        return false;
    k->used = ++g->loops->launches;
    gpu_note(g, cudaGraphLaunch(k->graph, g->stream));
    return true;
}

void gpu_loops_close(struct gpu *g)
{
    if (!g->loops)
        return;
    for (struct kept *k = g->loops->first; k; k = k->next)
        cudaGraphExecDestroy(k->graph);
    if (g->loops->stream)
        cudaStreamDestroy(g->loops->stream);
}
