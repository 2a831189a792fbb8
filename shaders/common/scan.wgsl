// Prefix sums over the records within a workgroup of GROUP_RECORDS.

#import generated/constants

var<workgroup> retained: array<u32, GROUP_RECORDS>;

// Runs in uniform control flow: number of selected records in the workgroup up to and including this one.
fn inclusive_scan(local: u32, keep: u32) -> u32 {
    retained[local] = keep;
    for (var reach = 1u; reach < GROUP_RECORDS; reach *= 2u) {
        workgroupBarrier();
        var sum = retained[local];
        if (local >= reach) {
            sum += retained[local - reach];
        }
        workgroupBarrier();
        retained[local] = sum;
    }
    workgroupBarrier();
    return retained[local];
}
