export type Three = [number, number, number];
export interface LiveBody {
    origin: Float64Array; attitude: Float64Array; omega: Float64Array;
    kinetic: number; strain: number; work: number; dissipation: number;
    linear: Float64Array; angular: Float64Array;
    energyBalance: number; linearBalance: Float64Array; angularBalance: Float64Array;
    coordinates: Float64Array;
}
export class Program {
    static begin(program: Uint8Array, run: Uint8Array, frame: number): Promise<Program>;
    numbers(): Float64Array;
    body(body: number): LiveBody;
    readonly pulled: { point: Float64Array; force: Float64Array };
    readonly time: number;
    readonly isRecorded: boolean;
    readonly steps: number;
    leadTo(time: number): void;
    restart(): void;
    change(change: [number, number, number], value: number): void;
    spin(body: number, value: number): void;
    pull(body: number, place: Three, shapes: number[], target: Three, stiffness: number, damping: number): void;
    movePull(target: Three): void;
    letGo(): void;
}
