export function bytesOf(base64: string): Uint8Array<ArrayBuffer>;
export function unpacked(bytes: Uint8Array<ArrayBuffer>): Promise<ArrayBuffer>;
