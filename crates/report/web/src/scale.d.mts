export const SCALE: string[];
