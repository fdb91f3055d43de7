/* SPDX-License-Identifier: Apache-2.0 */
/* Measures how long small kernels take one after another, by the ways in which
 * a step could queue them: `make launches` on a machine with a device. Each way
 * runs segments of a few kernels; the ways differ in what lies between two
 * segments. */
#include <cuda_runtime.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { SEGMENTS = 20, KERNELS = 8, RUNS = 101, BLOCKS = 64, THREADS = 256 };

static cudaStream_t stream, capture;
static float *data;
static int *turn;           /* on the device: turns of a WHILE node */
static volatile int *shown; /* on the host, written by the device */
static int *shown_there;

static void check(cudaError_t error)
{
    if (error == cudaSuccess)
        return;
    fprintf(stderr, "launches: %s\n", cudaGetErrorString(error));
    exit(1);
}

static __global__ void work_kernel(float *a)
{
    int k = (int)(blockIdx.x * blockDim.x + threadIdx.x);
    a[k] = a[k] * 0.5f + 1;
}

static __global__ void show_kernel(volatile int *to, int value)
{
    *to = value;
}

static __global__ void turn_kernel(cudaGraphConditionalHandle again, int *turn,
                                   int turns)
{
    *turn = *turn + 1 < turns ? *turn + 1 : 0;
    cudaGraphSetConditional(again, *turn != 0);
}

static __global__ void choose_kernel(cudaGraphConditionalHandle which,
                                     int value)
{
    cudaGraphSetConditional(which, (unsigned)value);
}

static void segment(cudaStream_t s)
{
    for (int k = 0; k < KERNELS; k++)
        work_kernel<<<BLOCKS, THREADS, 0, s>>>(data);
}

static void in_stream(cudaGraphExec_t)
{
    for (int k = 0; k < SEGMENTS; k++)
        segment(stream);
}

/* The host reads back a word of each segment before it launches the next one.
 */
static void with_looks(cudaGraphExec_t)
{
    for (int k = 1; k <= SEGMENTS; k++) {
        segment(stream);
        show_kernel<<<1, 1, 0, stream>>>(shown_there, k);
        while (*shown != k && cudaPeekAtLastError() == cudaSuccess)
            ;
        check(cudaGetLastError()); /* a failed launch would never be seen */
    }
}

static void as_graph(cudaGraphExec_t graph)
{
    check(cudaGraphLaunch(graph, stream));
}

/* Captures the launches that follow into graph g, after node `after` if that is
 * not NULL. */
static void begin(cudaGraph_t g, cudaGraphNode_t *after)
{
    check(cudaStreamBeginCaptureToGraph(capture, g, after, NULL, after != NULL,
                                        cudaStreamCaptureModeRelaxed));
}

/* Ends the capture and returns its last node. */
static cudaGraphNode_t end(void)
{
    cudaStreamCaptureStatus status;
    const cudaGraphNode_t *last;
    size_t n;
    cudaGraph_t g;
    check(cudaStreamGetCaptureInfo(capture, &status, NULL, NULL, &last, NULL,
                                   &n));
    cudaGraphNode_t node = last[0];
    check(cudaStreamEndCapture(capture, &g));
    return node;
}

static cudaGraph_t add_conditional(cudaGraph_t g, cudaGraphNode_t *after,
                                   enum cudaGraphConditionalNodeType type,
                                   cudaGraphConditionalHandle handle,
                                   cudaGraphNode_t *node)
{
    cudaGraphNodeParams p = {};
    p.type = cudaGraphNodeTypeConditional;
    p.conditional.handle = handle;
    p.conditional.type = type;
    p.conditional.size = 1;
    check(cudaGraphAddNode(node, g, after, NULL, after != NULL, &p));
    return p.conditional.phGraph_out[0];
}

static void plain(cudaGraph_t g)
{
    begin(g, NULL);
    for (int k = 0; k < SEGMENTS; k++)
        segment(capture);
    end();
}

/* The segments are the turns of one loop. */
static void loop(cudaGraph_t g)
{
    cudaGraphNode_t node;
    cudaGraphConditionalHandle again;
    check(cudaGraphConditionalHandleCreate(&again, g, 1,
                                           cudaGraphCondAssignDefault));
    begin(add_conditional(g, NULL, cudaGraphCondTypeWhile, again, &node), NULL);
    segment(capture);
    turn_kernel<<<1, 1, 0, capture>>>(again, turn, SEGMENTS);
    end();
}

/* Each segment is the body of an IF node, whose condition a kernel sets. */
static void choices(cudaGraph_t g, int taken)
{
    cudaGraphNode_t last, *after = NULL;
    for (int k = 0; k < SEGMENTS; k++, after = &last) {
        cudaGraphConditionalHandle which;
        check(cudaGraphConditionalHandleCreate(&which, g, 0,
                                               cudaGraphCondAssignDefault));
        begin(g, after);
        choose_kernel<<<1, 1, 0, capture>>>(which, taken);
        cudaGraphNode_t chosen = end();
        begin(add_conditional(g, &chosen, cudaGraphCondTypeIf, which, &last),
              NULL);
        segment(capture);
        end();
    }
}

static void taken(cudaGraph_t g)
{
    choices(g, 1);
}

static void left_out(cudaGraph_t g)
{
    choices(g, 0);
}

/* Each segment lies in the body of the IF node of the segment before, which
 * sets the condition. */
static void nested(cudaGraph_t g)
{
    for (int k = 0; k < SEGMENTS; k++) {
        cudaGraphConditionalHandle next;
        cudaGraphNode_t last, node;
        check(cudaGraphConditionalHandleCreate(&next, g, 0,
                                               cudaGraphCondAssignDefault));
        begin(g, NULL);
        segment(capture);
        choose_kernel<<<1, 1, 0, capture>>>(next, 1);
        last = end();
        g = add_conditional(g, &last, cudaGraphCondTypeIf, next, &node);
    }
    begin(g, NULL); /* the body of a node must not be empty */
    work_kernel<<<BLOCKS, THREADS, 0, capture>>>(data);
    end();
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Prints the median time, µs, from before the launch until the stream is empty.
 */
static void time_way(const char *name, void run(cudaGraphExec_t),
                     void build(cudaGraph_t))
{
    cudaGraph_t g;
    cudaGraphExec_t graph = NULL;
    double us[RUNS];
    if (build) {
        check(cudaGraphCreate(&g, 0));
        build(g);
        check(cudaGraphInstantiate(&graph, g, 0));
    }
    for (int k = 0; k < RUNS; k++) {
        *shown = 0;
        double start = now();
        run(graph);
        check(cudaStreamSynchronize(stream));
        us[k] = now() - start;
    }
    qsort(us, RUNS, sizeof *us, by_size);
    printf("%s,%.1f,%.2f\n", name, us[RUNS / 2], us[RUNS / 2] / (int)SEGMENTS);
}

int main(void)
{
    struct cudaDeviceProp device;
    check(cudaGetDeviceProperties(&device, 0));
    check(cudaStreamCreate(&stream));
    check(cudaStreamCreateWithFlags(&capture, cudaStreamNonBlocking));
    check(cudaMalloc(&data, BLOCKS * THREADS * sizeof *data));
    check(cudaMemset(data, 0, BLOCKS * THREADS * sizeof *data));
    check(cudaMalloc(&turn, sizeof *turn));
    check(cudaMemset(turn, 0, sizeof *turn));
    check(cudaHostAlloc((void **)&shown_there, sizeof *shown_there,
                        cudaHostAllocMapped));
    shown = shown_there;
    printf("# %s, %d segments of %d kernels\n", device.name, SEGMENTS, KERNELS);
    puts("way,us,us a segment");
    time_way("launched", in_stream, NULL);
    time_way("launched; the host looks after each", with_looks, NULL);
    time_way("one graph", as_graph, plain);
    time_way("turns of a WHILE node", as_graph, loop);
    time_way("IF nodes; all taken", as_graph, taken);
    time_way("IF nodes; none taken", as_graph, left_out);
    time_way("IF nodes, one in another", as_graph, nested);
    return 0;
}
