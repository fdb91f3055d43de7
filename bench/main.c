/* SPDX-License-Identifier: Apache-2.0 */
/* Prints the price of exactness as csv: `make price` on a machine with a
 * device. */
#include <stdio.h>

#include "gpu/run/gpu.h"

int price_run_32(struct gpu *g);
int price_run_64(struct gpu *g);

int main(void)
{
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    if (!g) {
        fputs("price: there is no device here\n", stderr);
        return 1;
    }
    printf("# %s, 1008 x 1008\n", gpu_name(g));
    puts("kernel,bits,flags,us,us cold,exact/this,exact/this cold,"
         "largest difference");
    status = price_run_32(g);
    if (!status)
        status = price_run_64(g);
    gpu_close(g);
    return status ? 1 : 0;
}
